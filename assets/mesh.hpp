#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace deforma {

/// A triangle surface in metres, counter-clockwise seen from outside.
struct Mesh {
  std::vector<Eigen::Vector3d> points;                  ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into points
};

/// What a mesh is like; `deforma mesh` prints it.
struct MeshFacts {
  std::size_t boundary_edges = 0;      ///< edges with one triangle: 0 for a closed mesh
  std::size_t non_manifold_edges = 0;  ///< edges with three or more triangles, or two that run the same way
  std::size_t components = 0;          ///< connected pieces
  double volume = 0.0;                 ///< enclosed, signed: negative when inside-out [m^3]
  double area = 0.0;                   ///< [m^2]
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();
};

MeshFacts inspect(const Mesh& mesh);

/// Every point p becomes rotation * (scale * p) + translation.
void transform(Mesh& mesh, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& scale,
               const Eigen::Vector3d& translation);

/// Splits every triangle into four, `times` times; points stay where they are, midpoints are shared.
void subdivide(Mesh& mesh, int times);

}  // namespace deforma
