#include "sim/step_control.hpp"

#include <algorithm>
#include <cmath>

#include "sim/divergence.hpp"

namespace deforma {

namespace {

constexpr double most_strain_change = 0.2;  // in one step, relative: else the stiffness at its end is another
constexpr double step_growth = 1.05;        // from one step to the next

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

void StrainSurvey::look(std::span<const Mat3> F, std::span<const Mat3> F_before, const InnerLoops& loops) {
  if (F.empty()) return;
  loops.survey(F.data()->data(), F_before.data()->data(), F.size(), exploded, &stiffening, &change);
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
