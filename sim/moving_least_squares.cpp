#include "sim/moving_least_squares.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <stdexcept>

#include "sim/blocks.hpp"
#include "sim/consistency.hpp"
#include "sim/parallel.hpp"
#include "sim/quadratic_fit.hpp"

namespace deforma {

namespace {

constexpr std::array<std::string_view, 2> names = {"linear", "quadratic"};
constexpr double dropped_eigenvalue = 1e-4;  // of the largest: below it a direction is not spanned
constexpr double least_weight = 0.3;         // of a particle's own cell: a negative one would be unstable

struct Moment {
  Mat3 inverse = Mat3::Zero();
  Mat3 projector = Mat3::Zero();
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
    moment.projector.setIdentity();
    return moment;
  }
  Mat3 V = eigen.eigenvectors();  // ascending eigenvalues
  V.leftCols(3 - rank).setZero();
  const Mat3 Q = V * V.transpose();
  // What is not spanned is filled up so that the rest can be inverted, then taken out again.
  const Mat3 filled = Q * A * Q + largest * (Mat3::Identity() - Q);
  moment.inverse = Q * filled.inverse() * Q;
  moment.projector = Q;
  return moment;
}

// What the strain energy at every particle weighs, so that quadratic fields integrate exactly: a cell's integral of a
// field is V f_i + first . grad f + second : grad grad f / 2, and the fit says how the derivatives of f depend on the
// neighbours' values. Inside, what a particle gives and takes cancels; near the surface the outermost gains.
std::vector<double> quadrature_weights(const Particles& particles, const Neighborhood& links,
                                       std::span<const QuadraticFit> fits, std::span<const Index> reverse) {
  std::vector<double> share(links.links.size(), 0.0), weight(particles.volume);
  if (particles.cells.empty()) return weight;
  parallel_for_each(particles.size(), [&](std::size_t i) {
    if (!fits[i].settled()) return;
    const QuadraticFit::Terms moments = fits[i].inverse() * fits[i].integrated(particles.cells[i]);
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      share[l] = static_cast<double>(link.weight) *
                 fits[i].terms(particles.rest[link.j] - particles.rest[i]).dot(moments);
    }
  });
  parallel_for_each(particles.size(), [&](std::size_t i) {
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) weight[i] += share[reverse[l]] - share[l];
    weight[i] = std::max(weight[i], least_weight * particles.volume[i]);
  });
  return weight;
}

void fit_quadratic(const Particles& particles, const Neighborhood& links, std::span<const Index> complete,
                   MovingLeastSquares& fit) {
  const std::size_t n = particles.size();
  std::vector<QuadraticFit> fits(n);
  parallel_for_each(n, [&](std::size_t i) { fits[i] = QuadraticFit(particles, links, i, fit.rank[i]); });
  fit.linear_fits = static_cast<std::size_t>(
      std::count_if(fits.begin(), fits.end(), [](const QuadraticFit& one) { return !one.settled(); }));
  fit.there.resize(links.links.size());
  fit.back.resize(links.links.size());
  parallel_for_each(n, [&](std::size_t i) {
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      fit.there[l].link = fit.back[l].link = link;
      gradient_vector(fit.there[l]) =
          fits[i].settled()
              ? Vec3(static_cast<double>(link.weight) *
                     fits[i].gradient_of(fits[i].terms(particles.rest[link.j] - particles.rest[i])))
              : Vec3(fit.inverse[i].transpose() * links.vector(i, link));
    }
  });
  const std::vector<Index> reverse = reverse_links(links);
  parallel_for_each(links.links.size(), [&](std::size_t l) {
    gradient_vector(fit.back[l]) = gradient_vector(fit.there[reverse[l]]);
  });
  fit.weight = quadrature_weights(particles, links, fits, reverse);
  fit.consistency = make_consistent(particles, links, complete, fits, reverse, fit);
  fit.sums.resize(n);
  parallel_for_each(n, [&](std::size_t i) {
    Range row = links.row(i);
    fit.sums[i].setZero();
    for (Index l = row.begin; l < row.end; ++l) fit.sums[i] += gradient_vector(fit.there[l]);
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
                                            Gradient gradient, std::span<const Index> complete) {
  std::size_t n = particles.size();
  if (links.size() != n)
    throw std::invalid_argument(fmt::format("{} particles but {} neighborhoods", n, links.size()));
  if (!particles.cells.empty() && particles.cells.size() != n)
    throw std::invalid_argument(fmt::format("{} particles but {} cells", n, particles.cells.size()));
  MovingLeastSquares fit;
  fit.inverse.resize(n);
  fit.rank.resize(n);
  fit.projectors.resize(n);
  fit.trace.resize(n);
  parallel_for_each(n, [&](std::size_t i) {
    Mat3 A = Mat3::Zero();
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      A += (particles.rest[link.j] - particles.rest[i]) * links.vector(i, link).transpose();
    }
    Moment moment = invert(A);
    fit.inverse[i] = moment.inverse;
    fit.rank[i] = moment.rank;
    fit.projectors[i] = moment.projector;
    fit.trace[i] = A.trace();
  });
  if (fit.count_below(3) == 0) std::vector<Mat3>().swap(fit.projectors);
  fit.weight = particles.volume;
  if (gradient == Gradient::quadratic) fit_quadratic(particles, links, complete, fit);
  return fit;
}

void deformation_gradients(const Neighborhood& links, const MovingLeastSquares& fit,
                           std::span<const Vec3> field, std::span<Mat3> F) {
  std::size_t n = links.size();
  if (field.size() != n || F.size() != n)
    throw std::invalid_argument(
        fmt::format("{} neighborhoods but {} values and {} gradients", n, field.size(), F.size()));
  const std::size_t blocks = (n + Block::most - 1) / Block::most;
  parallel_for_each(
      blocks,
      [&](std::size_t b) {
        const auto begin = static_cast<Index>(b) * Block::most;
        const Range particles{begin, std::min(begin + Block::most, static_cast<Index>(n))};
        block_deformation_gradients(links, fit, field, particles, F.subspan(begin, particles.size()));
      },
      4);
}

void block_deformation_gradients(const Neighborhood& links, const MovingLeastSquares& fit,
                                 std::span<const Vec3> field, Range particles, std::span<Mat3> F) {
  if (F.size() != particles.size())
    throw std::invalid_argument(fmt::format("{} particles but {} gradients", particles.size(), F.size()));
  if (F.empty()) return;
  const double* const u = field.data()->data();
  const double* const Q = fit.projectors.empty() ? nullptr : fit.projectors.data()->data();
  const InnerLoops& loops = links.loops();
  if (fit.quadratic())
    loops.quadratic_gradient(links.rows(fit.there, particles), u, Q, F.data()->data());
  else
    loops.linear_gradient(links.rows(links.links, particles), links.places.data(), fit.inverse.data()->data(),
                          u, Q, F.data()->data());
}

}  // namespace deforma
