#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "assets/solid.hpp"

namespace deforma {

/// The part of a solid that lies nearer to one point than to any other, by its moments about that point.
struct CellMoments {
  double volume = 0.0;                               ///< [m^3]
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   ///< integral of X - X_i [m^4]
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< integral of (X - X_i)(X - X_i)^T [m^5]
};

/// The Voronoi cells of points in a solid, clipped by its surface, found by counting small cubes (four to a spacing)
/// whose middle is inside. Whole cells of a regular lattice come out exactly; a box that is a whole number of such cubes
/// long, wide and high does so altogether. The volumes add up to the solid's.
///
/// An open mesh has no inside sharp enough for this: there every point gets an equal share and no moments.
/// @param spacing of the points, (V/N)^(1/3) or that of their lattice [m]
/// @param lattice whether the points are those of a lattice with this spacing but for some near the surface: then
///        points deep inside are known to have whole cells, and cost nothing
std::vector<CellMoments> particle_cells(const Solid& solid, std::span<const Eigen::Vector3d> points,
                                        double spacing, bool lattice);

}  // namespace deforma
