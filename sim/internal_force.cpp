#include "sim/internal_force.hpp"

#include <fmt/core.h>

#include <stdexcept>

#include "sim/parallel.hpp"

namespace deforma {

namespace {

void add_trapezoid_residual(const Particles& particles, const Neighborhood& links,
                            const MovingLeastSquares& fit, std::span<const Vec3> displacement,
                            std::span<const Mat3> F, std::span<const double> s, std::span<Mat3> B,
                            std::span<Vec3> force) {
  parallel_for_each(particles.size(), [&](std::size_t i) {
    const Mat3 own = F[i] - fit.plane[i];
    const Vec3 u = displacement[i], rest = particles.rest[i];
    const double s_own = s[i];
    Mat3 moment = Mat3::Zero();
    Vec3 sum = Vec3::Zero();
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      const Vec3 X = particles.rest[link.j] - rest;
      const Vec3 e = displacement[link.j] - u - 0.5 * ((own + (F[link.j] - fit.plane[link.j])) * X);
      const Vec3 f = ((s_own + s[link.j]) * link.weight) * e;
      sum += f;
      moment.noalias() += f * X.transpose();
    }
    force[i] += sum;
    B[i] -= 0.5 * moment;
  });
}

void add_quadratic_force(const Neighborhood& links, const MovingLeastSquares& fit, std::span<const Mat3> B,
                         std::span<Vec3> force) {
  parallel_for_each(links.size(), [&](std::size_t i) {
    Vec3 sum = Vec3::Zero();
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) sum.noalias() += B[links.links[l].j] * fit.pairs[l].back;
    force[i] += B[i] * fit.sums[i] - sum;
  });
}

}  // namespace

void carried_stress(const Particles& particles, const Neighborhood& links, const MovingLeastSquares& fit,
                    std::span<const Vec3> displacement, std::span<const Mat3> F, std::span<const Mat3> P,
                    std::span<const double> pair_stiffness, std::span<Mat3> B, std::span<Vec3> force) {
  if (fit.quadratic()) {
    parallel_for_each(particles.size(), [&](std::size_t i) { B[i] = fit.weight[i] * P[i]; });
    if (!pair_stiffness.empty())
      add_trapezoid_residual(particles, links, fit, displacement, F, pair_stiffness, B, force);
    return;
  }
  parallel_for_each(particles.size(), [&](std::size_t i) {
    B[i].noalias() = fit.weight[i] * P[i] * fit.inverse[i].transpose();
    if (!pair_stiffness.empty()) B[i] -= (pair_stiffness[i] * links.length[i]) * (F[i] - fit.plane[i]);
  });
}

void add_internal_force(const Neighborhood& links, const MovingLeastSquares& fit, std::span<const Mat3> B,
                        std::span<const double> pair_stiffness, std::span<const Vec3> displacement,
                        std::span<Vec3> force) {
  std::size_t n = links.size();
  bool hourglass = !pair_stiffness.empty();
  if (B.size() != n || force.size() != n || displacement.size() != n ||
      (hourglass && pair_stiffness.size() != n))
    throw std::invalid_argument(
        fmt::format("{} neighborhoods but {} stresses, {} displacements, {} forces and {} pair stiffnesses",
                    n, B.size(), displacement.size(), force.size(), pair_stiffness.size()));
  if (fit.quadratic()) return add_quadratic_force(links, fit, B, force);
  parallel_for_each(n, [&](std::size_t i) {
    // B_i + B_j inside the sum, not pulled out of it: the pair's two forces must be exactly opposite.
    const Mat3 own = B[i];
    Vec3 sum = Vec3::Zero();
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = links.links[l];
      sum.noalias() += (own + B[link.j]) * link.vector();  // eq 17 and its reaction
    }
    if (hourglass) {
      const double s = pair_stiffness[i];
      const Vec3 u = displacement[i];
      for (Index l = row.begin; l < row.end; ++l) {
        const Link& link = links.links[l];
        sum += ((s + pair_stiffness[link.j]) * link.weight) * (displacement[link.j] - u);
      }
    }
    force[i] += sum;
  });
}

}  // namespace deforma
