#pragma once

#include <span>
#include <vector>

#include "sim/moving_least_squares.hpp"
#include "sim/neighborhood.hpp"
#include "sim/particles.hpp"
#include "sim/quadratic_fit.hpp"
#include "sim/skin.hpp"

namespace deforma {

/// Changes the gradient vectors g_ij as little as possible (least sum |delta g|^2 / W) so that a uniform stress
/// leaves no force inside, however irregular the particles: sum_i w_i G_ik = 0 for every particle k whose support
/// lies within its body, with G_ik = g_ik and G_kk = -sum_j g_kj. What the fits reproduce, linear and quadratic
/// fields, they still reproduce. It is the equilibrium patch test that this passes; energy and momentum are untouched.
///
/// With one multiplier l_k for each such particle (0 for the others), delta g_ij = w_i W_ij times what the fit of i
/// leaves over of l at j: a sparse symmetric positive system, solved by conjugate gradients.
/// Source: the variationally consistent integration of Chen, Hillman & Rueter (2013), in the nodal form.
///
/// @param fits one for each particle; its row is left alone where it is not settled
/// @param fit  quadratic; its pairs are changed
Consistency make_consistent(const Particles& particles, const Neighborhood& links,
                            std::span<const Index> complete, std::span<const QuadraticFit> fits,
                            std::span<const Index> reverse, MovingLeastSquares& fit);

/// Particles no part of whose body's surface is within their support radius, ascending.
struct CompleteNeighborhoods {
  std::vector<Index> particles;
  std::size_t left_out =
      0;  ///< those of bodies that have more than 2000, for which the correction takes too long
};
CompleteNeighborhoods complete_neighborhoods(const Particles& particles, std::span<const Body> bodies,
                                             const Neighborhood& links, const Surface& surface);

}  // namespace deforma
