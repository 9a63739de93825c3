#pragma once

#include <span>
#include <vector>

#include "sim/neighborhood.hpp"
#include "sim/types.hpp"

namespace deforma {

/// The constant part of the least-squares gradient (eqs 6-8): grad u_i = (sum_j u_ij (W X)_ij^T) inverse_i.
///
/// `inverse` already holds the 1/l that undoes the links' scaling. A neighbourhood that does not span space
/// has rank below 3: its inverse is a pseudoinverse, and `plane` holds the projector Q onto what it spans.
struct MovingLeastSquares {
  std::vector<Mat3> inverse;       ///< (A^-1)/l per particle [1/m]
  std::vector<std::uint8_t> rank;  ///< 0 (alone), 1 (rope), 2 (sheet), 3
  std::vector<Mat3> plane;         ///< Q; the identity for rank 3
  std::vector<double> trace;       ///< tr A, dimensionless

  std::size_t count_below(int rank_limit) const;
};

/// Moment matrices and their inverses, eigenvalues below 1e-4 of the largest
/// dropped. Linear fields are reproduced to rounding. (Paper eqs 6-8; the exact inverse of the slightly
/// unsymmetric matrix.)
MovingLeastSquares fit_moving_least_squares(const Particles& particles, const Neighborhood& links);

/// F_i = Q_i + grad u_i of every particle (eqs 2, 9), with row = component of u and column = rest direction.
/// For rank 3 this is I + grad u.
/// @param field u [m]    n
/// @param F     written  n
/// @throws std::invalid_argument when the lengths differ.
void deformation_gradients(const Neighborhood& links, const MovingLeastSquares& fit,
                           std::span<const Vec3> field, std::span<Mat3> F);

}  // namespace deforma
