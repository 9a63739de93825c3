#include "sim/moving_least_squares.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>

#include "sim/parallel.hpp"

namespace deforma {

namespace {

constexpr double dropped_eigenvalue = 1e-4;  // of the largest: below it a direction is not spanned

struct Moment {
  Mat3 inverse = Mat3::Zero();
  Mat3 plane = Mat3::Zero();
  std::uint8_t rank = 0;
};

// A is symmetric but for rounding; the rank comes from its symmetric part, the inverse from itself, so that
// linear fields come out exactly.
Moment invert(const Mat3& A) {
  Moment moment;
  Eigen::SelfAdjointEigenSolver<Mat3> eigen(0.5 * (A + A.transpose()));
  double largest = eigen.eigenvalues().maxCoeff();
  if (!(largest > 0.0)) return moment;
  int rank = static_cast<int>((eigen.eigenvalues().array() > dropped_eigenvalue * largest).count());
  moment.rank = static_cast<std::uint8_t>(rank);
  if (rank == 3) {
    moment.inverse = A.inverse();
    moment.plane.setIdentity();
    return moment;
  }
  Eigen::Matrix<double, 3, Eigen::Dynamic> V = eigen.eigenvectors().rightCols(rank);  // ascending eigenvalues
  Eigen::MatrixXd reduced = V.transpose() * A * V;
  moment.inverse = V * reduced.inverse() * V.transpose();
  moment.plane = V * V.transpose();
  return moment;
}

}  // namespace

std::size_t MovingLeastSquares::count_below(int rank_limit) const {
  return static_cast<std::size_t>(
      std::count_if(rank.begin(), rank.end(), [&](std::uint8_t r) { return r < rank_limit; }));
}

MovingLeastSquares fit_moving_least_squares(const Particles& particles, const Neighborhood& links) {
  std::size_t n = particles.size();
  if (links.size() != n)
    throw std::invalid_argument(fmt::format("{} particles but {} neighborhoods", n, links.size()));
  MovingLeastSquares fit;
  fit.inverse.resize(n);
  fit.rank.resize(n);
  fit.plane.resize(n);
  fit.trace.resize(n);
  parallel_for_each(n, [&](std::size_t i) {
    Mat3 A = Mat3::Zero();
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      A += (particles.rest[link.j] - particles.rest[i]) / links.length[i] * link.vector().transpose();
    }
    Moment moment = invert(A);
    fit.inverse[i] = moment.inverse / links.length[i];
    fit.rank[i] = moment.rank;
    fit.plane[i] = moment.plane;
    fit.trace[i] = A.trace();
  });
  return fit;
}

void deformation_gradients(const Neighborhood& links, const MovingLeastSquares& fit,
                           std::span<const Vec3> field, std::span<Mat3> F) {
  std::size_t n = links.size();
  if (field.size() != n || F.size() != n)
    throw std::invalid_argument(
        fmt::format("{} neighborhoods but {} values and {} gradients", n, field.size(), F.size()));
  parallel_for_each(n, [&](std::size_t i) {
    Mat3 sum = Mat3::Zero();
    Range row = links.row(i);
    const Vec3 own = field[i];
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      sum.noalias() += (field[link.j] - own) * link.vector().transpose();  // eq 8
    }
    F[i] = fit.plane[i];
    F[i].noalias() += sum * fit.inverse[i];  // eq 7
  });
}

}  // namespace deforma
