#include "sim/moving_least_squares.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <stdexcept>

#include "sim/parallel.hpp"

namespace deforma {

namespace {

constexpr std::array<std::string_view, 2> names = {"linear", "quadratic"};
constexpr double dropped_eigenvalue = 1e-4;  // of the largest: below it a direction is not spanned
constexpr double dropped_quadratic_eigenvalue =
    1e-6;  // of the largest: below it the neighbours do not settle the fit

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
  Mat3 V = eigen.eigenvectors();  // ascending eigenvalues
  V.leftCols(3 - rank).setZero();
  const Mat3 Q = V * V.transpose();
  // What is not spanned is filled up so that the rest can be inverted, then taken out again.
  const Mat3 filled = Q * A * Q + largest * (Mat3::Identity() - Q);
  moment.inverse = Q * filled.inverse() * Q;
  moment.plane = Q;
  return moment;
}

// Dynamic sizes with a fixed bound: neither the heap, nor the minutes of compiling that unrolled 9 x 9 products take.
using Vec9 = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 9, 1>;
using Mat9 = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 9, 9>;

// Linear and quadratic terms of the Taylor expansion about the particle.
Vec9 taylor_terms(const Vec3& X) {
  Vec9 p(9);
  p << X, 0.5 * X.x() * X.x(), 0.5 * X.y() * X.y(), 0.5 * X.z() * X.z(), X.y() * X.z(), X.z() * X.x(),
      X.x() * X.y();
  return p;
}

// g_ij of one particle's row: its gradient is what the linear coefficients of the weighted fit are. False when the
// neighbours do not settle nine coefficients.
bool quadratic_row(const Particles& particles, const Neighborhood& links, std::size_t i,
                   std::vector<MovingLeastSquares::Pair>& pairs) {
  Range row = links.row(i);
  if (row.size() < 9) return false;
  const double h = links.support[i];
  Mat9 M = Mat9::Zero(9, 9);
  for (Index l = row.begin; l < row.end; ++l) {
    Vec9 p = taylor_terms((particles.rest[links.links[l].j] - particles.rest[i]) / h);
    M += static_cast<double>(links.links[l].weight) * p * p.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat9> eigen(M);
  const auto& values = eigen.eigenvalues();  // ascending
  if (!(values[0] > dropped_quadratic_eigenvalue * values[8])) return false;
  const Mat9 scaled = eigen.eigenvectors() * values.cwiseInverse().asDiagonal();
  const Mat9 gradient_rows =
      scaled * eigen.eigenvectors().topRows(3).transpose();  // of M^-1, the linear columns
  for (Index l = row.begin; l < row.end; ++l) {
    Vec9 p = taylor_terms((particles.rest[links.links[l].j] - particles.rest[i]) / h);
    pairs[l].there = links.links[l].weight / h * (gradient_rows.transpose() * p);
  }
  return true;
}

void fit_quadratic(const Particles& particles, const Neighborhood& links, MovingLeastSquares& fit) {
  std::size_t n = particles.size();
  fit.pairs.resize(links.links.size());
  std::vector<std::uint8_t> left(n, 0);
  parallel_for_each(n, [&](std::size_t i) {
    left[i] = !quadratic_row(particles, links, i, fit.pairs);
    Range row = links.row(i);
    if (left[i])
      for (Index l = row.begin; l < row.end; ++l)
        fit.pairs[l].there = fit.inverse[i].transpose() * links.links[l].vector();
  });
  fit.linear_fits = static_cast<std::size_t>(std::count(left.begin(), left.end(), 1));
  // Rows are ascending in j and links symmetric, so the reverse of link i -> j is found by bisection.
  parallel_for_each(n, [&](std::size_t i) {
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      Range other = links.row(links.links[l].j);
      auto reverse = std::lower_bound(links.links.begin() + other.begin, links.links.begin() + other.end, i,
                                      [](const Link& link, std::size_t target) { return link.j < target; });
      fit.pairs[l].back = fit.pairs[static_cast<std::size_t>(reverse - links.links.begin())].there;
    }
  });
}

}  // namespace

Gradient gradient_from_name(std::string_view name) {
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return static_cast<Gradient>(k);
  throw std::invalid_argument(
      fmt::format("unknown gradient '{}' (allowed: {})", name, fmt::join(names, ", ")));
}

std::string_view gradient_name(Gradient gradient) { return names.at(static_cast<std::size_t>(gradient)); }

std::span<const std::string_view> gradient_names() { return names; }

std::size_t MovingLeastSquares::count_below(int rank_limit) const {
  return static_cast<std::size_t>(
      std::count_if(rank.begin(), rank.end(), [&](std::uint8_t r) { return r < rank_limit; }));
}

MovingLeastSquares fit_moving_least_squares(const Particles& particles, const Neighborhood& links,
                                            Gradient gradient) {
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
  if (gradient == Gradient::quadratic) fit_quadratic(particles, links, fit);
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
    F[i] = fit.plane[i];
    if (fit.quadratic()) {
      for (Index l = row.begin; l < row.end; ++l)
        F[i].noalias() += (field[links.links[l].j] - own) * fit.pairs[l].there.transpose();
      return;
    }
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      sum.noalias() += (field[link.j] - own) * link.vector().transpose();  // eq 8
    }
    F[i].noalias() += sum * fit.inverse[i];  // eq 7
  });
}

}  // namespace deforma
