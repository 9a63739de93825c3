#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim/neighborhood.hpp"
#include "sim/particles.hpp"
#include "sim/types.hpp"

namespace deforma {

/// The weighted quadratic fit of one particle's neighbourhood: a Taylor expansion about the particle whose
/// coefficients are found by least squares with the links' weights.
///
/// Of nine terms (gradient and second derivatives) as many are fitted as the neighbours settle. A body two
/// layers thick cannot tell the second derivative across from the first, and it is left out; a flat sheet has five
/// terms in its plane and a straight rope two along itself. Where none of these will do there is no quadratic fit.
class QuadraticFit {
 public:
  // Dynamic sizes with a fixed bound: neither the heap, nor the minutes of compiling that unrolled 9 x 9 products take.
  using Terms = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 9, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 9, 9>;

  /// None: not settled.
  QuadraticFit() = default;

  /// @param rank of the particle's linear moment matrix, which a fit in a plane or along a line must agree with
  QuadraticFit(const Particles& particles, const Neighborhood& links, std::size_t i, int rank);

  bool settled() const { return inverse_.size() > 0; }

  /// The fitted terms at a rest offset from the particle [m]; dimensionless.
  Terms terms(const Vec3& offset) const;

  /// The inverse moment matrix: coefficients are inverse * sum_j W_ij terms(X_ij) (f_j - f_i).
  const Square& inverse() const { return inverse_; }

  /// g_ij without its weight: what a neighbour's difference adds to the gradient, per weight [1/m].
  Vec3 gradient_of(const Terms& terms) const;

  /// The terms integrated over a cell with these moments about the particle [m^3].
  Terms integrated(const Cell& cell) const;

 private:
  // False when the neighbours do not settle the chosen terms: then `unsettled` is the combination they tell least of.
  bool fit(const Particles& particles, const Neighborhood& links, std::size_t i, std::span<const int> chosen,
           Terms* unsettled);
  // The moment matrix of the chosen terms.
  Square moments(const Particles& particles, const Neighborhood& links, std::size_t i) const;
  // The same answer as `fit`, from the matrix' eigenvalues.
  bool decompose(const Square& M, Terms* unsettled);

  Mat3 axes_ = Mat3::Identity();  // columns; the last is the thinnest direction
  double h_ = 1.0;                // [m]
  std::span<const int> chosen_;   // of the nine
  Square inverse_;
};

/// Where the reverse of each link stands among the links.
std::vector<Index> reverse_links(const Neighborhood& links);

}  // namespace deforma
