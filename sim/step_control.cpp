#include "sim/step_control.hpp"

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

void StrainSurvey::look(const Mat3& F, const Mat3& F_before) {
  const double squared = F.squaredNorm();
  if (!(squared < exploded * exploded)) {
    stiffening = std::numeric_limits<double>::infinity();
    return;
  }
  stiffening = std::max(stiffening, deforma::stiffening(F));
  change = std::max(change, (F - F_before).squaredNorm() / std::max(squared, 1.0));
}

void StepControl::observe(std::span<const Block> blocks, std::span<const StrainSurvey> surveys,
                          double last_step) {
  double change = 0.0;
  std::fill(conditions_.stiffening.begin(), conditions_.stiffening.end(), 0.0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    double& stiffening = conditions_.stiffening[blocks[b].body];
    stiffening = std::max(stiffening, surveys[b].stiffening);
    change = std::max(change, surveys[b].change);
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
