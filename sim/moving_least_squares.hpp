#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "sim/neighborhood.hpp"
#include "sim/types.hpp"

namespace deforma {

/// What the neighbours' displacements are fitted with to take a particle's gradient.
enum class Gradient {
  linear,    ///< the paper's: three coefficients, first order at the boundary
  quadratic  ///< nine: second order there too; wants more neighbours and a smaller step
};

/// @throws std::invalid_argument for a name that is no gradient; the message lists the names.
Gradient gradient_from_name(std::string_view name);
std::string_view gradient_name(Gradient gradient);
std::span<const std::string_view> gradient_names();

/// What became of making the gradients consistent (see consistency.hpp).
struct Consistency {
  std::size_t corrected = 0;  ///< particles for which the sum was made to vanish
  std::size_t left_out = 0;   ///< in bodies with too many of them
  int iterations = 0;         ///< of the conjugate gradients, of the body that took most
  double remainder =
      0.0;  ///< the largest |sum_i V_i G_ik| left in a body, of its largest before; 0 if there was none
};

/// The constant part of the least-squares gradient (eqs 6-8): grad u_i = (sum_j u_ij (W X_ij)^T) inverse_i,
/// or, with the quadratic fit, grad u_i = sum_j u_ij g_ij^T.
///
/// A neighbourhood that does not span space has rank below 3: its inverse is a pseudoinverse, and Q the projector onto
/// what it spans.
struct MovingLeastSquares {
  std::vector<Mat3> inverse;       ///< A^-1 per particle [m^-2]
  std::vector<std::uint8_t> rank;  ///< 0 (alone), 1 (rope), 2 (sheet), 3
  std::vector<Mat3> projectors;    ///< Q; or empty where every neighbourhood spans space
  std::vector<double> trace;       ///< tr A [m^2]
  std::vector<double> weight;      ///< of the strain energy at a particle [m^3]
  // For the quadratic fit, else empty:
  std::vector<GradientLink> there;  ///< g_ij beside the links [1/m]
  std::vector<GradientLink> back;   ///< g_ji beside them
  std::vector<Vec3> sums;           ///< sum_j g_ij per particle [1/m]
  std::size_t linear_fits = 0;      ///< particles that the quadratic fit left to the linear one
  Consistency consistency;

  bool quadratic() const { return !there.empty(); }
  /// Q; the identity for rank 3.
  const Mat3& projector(std::size_t i) const {
    static const Mat3 identity = Mat3::Identity();
    return projectors.empty() ? identity : projectors[i];
  }
  std::size_t count_below(int rank_limit) const;
};

/// g of a link [1/m].
inline Eigen::Map<const Vec3> gradient_vector(const GradientLink& link) {
  return Eigen::Map<const Vec3>(link.g);
}
inline Eigen::Map<Vec3> gradient_vector(GradientLink& link) { return Eigen::Map<Vec3>(link.g); }

/// Moment matrices and their inverses, eigenvalues below 1e-4 of the largest dropped. Linear fields are
/// reproduced to rounding (paper eqs 6-8); by the quadratic fit quadratic ones, too, wherever the neighbours settle
/// it (see `QuadraticFit`); elsewhere the linear fit stands in.
///
/// The weight with which a particle's strain energy counts is its volume. With the quadratic fit and the particles'
/// cells known, it is corrected so that quadratic fields are integrated exactly over the body: the midpoint rule that
/// plain volumes amount to makes a bar of n particles across 1/n^2 too soft in bending.
///
/// @param complete particles inside, ascending, for which the quadratic fit is made consistent (consistency.hpp)
MovingLeastSquares fit_moving_least_squares(const Particles& particles, const Neighborhood& links,
                                            Gradient gradient = Gradient::linear,
                                            std::span<const Index> complete = {});

/// F_i = Q_i + grad u_i of every particle (eqs 2, 9), with row = component of u and column = rest direction.
/// For rank 3 this is I + grad u.
/// @param field u [m]    n
/// @param F     written  n
/// @throws std::invalid_argument when the lengths differ.
void deformation_gradients(const Neighborhood& links, const MovingLeastSquares& fit,
                           std::span<const Vec3> field, std::span<Mat3> F);

/// The same of a block's particles alone, at most Block::most of them.
/// @param F written    as many as the block has particles
void block_deformation_gradients(const Neighborhood& links, const MovingLeastSquares& fit,
                                 std::span<const Vec3> field, Range particles, std::span<Mat3> F);

}  // namespace deforma
