#pragma once

#include <Eigen/Core>
#include <vector>

#include "assets/solid.hpp"

namespace deforma {

/// Where the points of a lattice lie in each of its cubic cells.
enum class CellKind {
  cubic,         ///< one, in the middle
  body_centered  ///< two, at a quarter and three quarters of the diagonal
};

/// The points of a clipped lattice with one point for each spacing^3, its cells in the middle of the solid's bounds: a
/// box that is a whole number of cells long, wide and high is filled with exactly these cells.
std::vector<Eigen::Vector3d> lattice_by_spacing(const Solid& solid, CellKind kind, double spacing);

/// Exactly `count` points of a clipped lattice.
///
/// Of the lattices that lie symmetrically in the bounds, and then of shifted ones, takes the one that comes closest
/// from above near spacing (V / count)^(1/3), and leaves out what is too much: nearest the surface first, of equally
/// near points the one farthest from the middle, then in order.
/// @param count above 0; the solid has a volume
/// @throws std::runtime_error when no lattice was found that has so many points inside.
std::vector<Eigen::Vector3d> lattice_by_count(const Solid& solid, CellKind kind, std::size_t count);

}  // namespace deforma
