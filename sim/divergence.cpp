#include "sim/divergence.hpp"

#include <fmt/core.h>

namespace deforma {

namespace {

std::size_t most_energetic(const State& state) {
  const Particles& p = state.particles;
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const double energy = p.mass[i] * p.velocity[i].squaredNorm();
    if (energy <= most) continue;
    most = energy;
    best = i;
  }
  return best;
}

/// Such as "body 'duck', particle 7": numbered within its body.
std::string name_of(const State& state, std::size_t i) {
  const Body& body = state.bodies[state.particles.body[i]];
  return fmt::format("body '{}', particle {}", body.name, i - body.particles.begin);
}

}  // namespace

void refuse_divergence(const State& state, bool finite_strain, double step_fraction) {
  for (std::size_t i = 0; i < state.size(); ++i) {
    bool fine = state.particles.displacement[i].allFinite() && state.particles.velocity[i].allFinite() &&
                (finite_strain || state.F[i].squaredNorm() < exploded * exploded);
    if (fine) continue;
    throw SimulationDiverged(
        fmt::format("the simulation diverged at t = {:.6g} s: {} is no longer finite "
                    "or is stretched beyond "
                    "{:g} times; lower [solver] step_fraction (now {:g}), or soften what drives it",
                    state.time, name_of(state, i), exploded, step_fraction));
  }
}

void refuse_energy(const State& state, double step_fraction) {
  throw SimulationDiverged(fmt::format(
      "the simulation went wrong by t = {:.6g} s: it has gained several times the energy that was put "
      "in, most of it now at {}; lower [solver] step_fraction (now {:g}), or soften "
      "what drives it",
      state.time, name_of(state, most_energetic(state)), step_fraction));
}

void refuse_step(const State& state, double step) {
  throw SimulationDiverged(
      fmt::format("the simulation cannot go on at t = {:.6g} s: its stable step has fallen to {:.3g} s; "
                  "something moves (most energy: {}) or is stiff beyond reason: look at loads, "
                  "velocities, 'young' and contact 'stiffness'",
                  state.time, step, name_of(state, most_energetic(state))));
}

}  // namespace deforma
