#include "sim/internal_force.hpp"

#include <fmt/core.h>

#include <array>
#include <stdexcept>

#include "sim/blocks.hpp"
#include "sim/huge_pages.hpp"
#include "sim/memory.hpp"
#include "sim/parallel.hpp"

namespace deforma {

namespace {

void put(double (&line)[4], const auto& three, double fourth) {
  line[0] = three[0];
  line[1] = three[1];
  line[2] = three[2];
  line[3] = fourth;
}

/// Calls visit(particles) for runs of particles, on several threads where there are many.
template <typename Visit>
void for_runs(std::size_t n, const Visit& visit) {
  parallel_for_each((n + Block::most - 1) / Block::most,
                    [&](std::size_t b) {
                      const auto begin = static_cast<Index>(b) * Block::most;
                      visit(Range{begin, std::min(begin + Block::most, static_cast<Index>(n))});
                    },
                    4);
}

}  // namespace

InternalForce::InternalForce(const State& state, bool hourglass)
    : carriers_(state.size()), residuals_(hourglass && state.fit.quadratic() ? state.size() : 0) {
  use_huge_pages(carriers_);
  use_huge_pages(residuals_);
}

void InternalForce::carry(const State& state, Range particles, std::span<const Vec3> displacement,
                          std::span<const Mat3> F, std::span<const Mat3> P,
                          std::span<const double> pair_stiffness) {
  const MovingLeastSquares& fit = state.fit;
  const bool quadratic = fit.quadratic(), hourglass = !pair_stiffness.empty();
  const std::size_t count = particles.size();
  if (displacement.size() != carriers_.size() || F.size() != count || P.size() != count ||
      (hourglass && pair_stiffness.size() != count))
    throw std::invalid_argument(
        fmt::format("{} of {} particles, but {} displacements, {} deformation gradients, {} stresses and {} "
                    "pair stiffnesses",
                    count, carriers_.size(), displacement.size(), F.size(), P.size(), pair_stiffness.size()));
  if (count == 0) return;
  const Index begin = particles.begin;
  if (!quadratic) {
    state.links.loops().linear_carry(
        {&state.links.places[begin], displacement[begin].data(), &fit.weight[begin],
         fit.inverse[begin].data(), P.data()->data(), F.data()->data(),
         fit.projectors.empty() ? nullptr : fit.projectors[begin].data(),
         hourglass ? pair_stiffness.data() : nullptr},
        count, &carriers_[begin]);
    return;
  }
  for (std::size_t k = 0, i = begin; k < count; ++k, ++i) {
    const Mat3 B = fit.weight[i] * P[k];
    for (int r = 0; r < 3; ++r) put(carriers_[i].line[r], B.row(r), 0.0);
    if (!hourglass) continue;
    const Mat3 gradient = F[k] - fit.projector(i);
    put(residuals_[i].head, displacement[i], pair_stiffness[k]);
    for (int c = 0; c < 3; ++c) put(residuals_[i].line[c], gradient.col(c), state.particles.rest[i][c]);
  }
}

void InternalForce::carry_residuals(const State& state, std::span<Vec3> force) {
  for_runs(state.size(), [&](Range particles) {
    std::array<double, 12ul * Block::most> moments;
    state.links.loops().quadratic_residual(state.links.rows(state.links.links, particles), residuals_.data(),
                                           force[particles.begin].data(), moments.data());
    for (Index i = particles.begin; i < particles.end; ++i)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          carriers_[i].line[r][c] -= 0.5 * moments[12ul * (i - particles.begin) + 4ul * c + r];
  });
}

void InternalForce::add_to(std::span<Vec3> force, const State& state) {
  const std::size_t n = carriers_.size();
  if (force.size() != n || state.size() != n)
    throw std::invalid_argument(
        fmt::format("stress of {} particles, but {} particles and {} forces", n, state.size(), force.size()));
  if (!residuals_.empty()) carry_residuals(state, force);
  const InnerLoops& loops = state.links.loops();
  const MovingLeastSquares& fit = state.fit;
  for_runs(n, [&](Range particles) {
    double* const own = force[particles.begin].data();
    if (!fit.quadratic()) {
      loops.linear_force(state.links.rows(state.links.links, particles), carriers_.data(), own);
      return;
    }
    for (Index i = particles.begin; i < particles.end; ++i)
      for (int r = 0; r < 3; ++r)
        force[i][r] += Eigen::Map<const Vec3>(carriers_[i].line[r]).dot(fit.sums[i]);
    loops.quadratic_force(state.links.rows(fit.back, particles), carriers_.data(), own);
  });
}

std::size_t InternalForce::bytes() const { return bytes_of(carriers_) + bytes_of(residuals_); }

}  // namespace deforma
