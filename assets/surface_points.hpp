#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <span>
#include <vector>

#include "assets/mesh.hpp"

namespace deforma {

/// Part of a mesh's surface: what lies in a box and, within it, in a ball. Everything by default.
struct SurfacePart {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());  ///< [m]
  Eigen::Vector3d max = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());   ///< [m]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                                           ///< [m]
  double radius = std::numeric_limits<double>::infinity();                                    ///< [m]
};

/// Covers parts of a surface as densely as points inside lie below it: for every point within reach of a part, and not in
/// it itself, the nearest place on the part, unless another such place is nearer than half the reach.
/// @param reach [m]
std::vector<Eigen::Vector3d> points_on_surface(const Mesh& mesh, std::span<const SurfacePart> parts,
                                               std::span<const Eigen::Vector3d> inside, double reach);

}  // namespace deforma
