#include "sim/step_control.hpp"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "sim/divergence.hpp"
#include "sim/material.hpp"

namespace deforma {

namespace {

constexpr double most_strain_change = 0.2;  // in one step, relative: else the stiffness at its end is another
constexpr double step_growth = 1.05;        // from one step to the next

// How much stiffer than at rest a material can have become under F, but for a constant: what multiplies the moduli in
// the second derivatives of the energies in use. The norm of F alone would not tell a pulled particle from a flattened
// one, whose cofactors are many times larger.
double stiffening(const Mat3& F) {
  const Mat3 C = cofactor(F);
  const double squared = F.squaredNorm();
  return 0.5 + squared + C.squaredNorm() + std::abs(F.col(0).dot(C.col(0)) - 1.0) * std::sqrt(squared);
}

struct StrainNow {
  double stiffening = 0.0;  // the largest; infinity when some F is not finite, or beyond reason
  double change = 0.0;      // the largest since the last step, squared, relative
};

StrainNow survey(std::span<const Mat3> F, std::span<const Mat3> F_before, Range particles) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(particles.begin, particles.end, 4096), StrainNow{},
      [&](const tbb::blocked_range<std::size_t>& block, StrainNow now) {
        for (std::size_t i = block.begin(); i != block.end(); ++i) {
          const double squared = F[i].squaredNorm();
          if (!(squared < exploded * exploded))
            return StrainNow{std::numeric_limits<double>::infinity(), 0.0};
          now.stiffening = std::max(now.stiffening, stiffening(F[i]));
          now.change = std::max(now.change, (F[i] - F_before[i]).squaredNorm() / std::max(squared, 1.0));
        }
        return now;
      },
      [](const StrainNow& a, const StrainNow& b) {
        return StrainNow{std::max(a.stiffening, b.stiffening), std::max(a.change, b.change)};
      });
}

double smallest_spacing(const State& state) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Body& body : state.bodies) smallest = std::min(smallest, body.spacing);
  return smallest;
}

}  // namespace

StepControl::StepControl(std::size_t bodies) {
  conditions_.stiffening.assign(bodies, 0.0);
  conditions_.key.assign(bodies, 0.0);
}

void StepControl::observe(const State& state, std::span<const Mat3> F_before, double last_step) {
  double change = 0.0;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const StrainNow now = survey(state.F, F_before, state.bodies[b].particles);
    conditions_.stiffening[b] = now.stiffening;
    change = std::max(change, now.change);
  }
  strain_rate_ = last_step > 0.0 ? std::sqrt(change) / last_step : 0.0;
}

bool StepControl::finite() const {
  return std::all_of(conditions_.stiffening.begin(), conditions_.stiffening.end(),
                     [](double stiffening) { return std::isfinite(stiffening); });
}

bool StepControl::stale(const State& state, std::span<const std::unique_ptr<Effect>> effects) {
  std::fill(conditions_.key.begin(), conditions_.key.end(), 0.0);
  for (const auto& effect : effects) effect->stiffness_key(state, conditions_.key);
  return probe_.stale(conditions_);
}

void StepControl::measure(const State& state, const StiffnessProbe::Force& force) {
  omega_ = probe_.measure(state.particles.displacement, state.particles.mass, state.fixed,
                          smallest_spacing(state), force);
  probe_.remember(conditions_);
}

double StepControl::step() {
  double step = omega_ > 0.0 ? 2.0 / omega_ : std::numeric_limits<double>::infinity();
  if (strain_rate_ > 0.0) step = std::min(step, most_strain_change / strain_rate_);
  return step_ = std::min(step, step_growth * step_before_);
}

}  // namespace deforma
