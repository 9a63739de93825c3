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

}  // namespace

void refuse_divergence(const State& state, bool finite_strain, double step_fraction) {
  for (std::size_t i = 0; i < state.size(); ++i) {
    bool fine = state.particles.displacement[i].allFinite() && state.particles.velocity[i].allFinite() &&
                (finite_strain || state.F[i].squaredNorm() < exploded * exploded);
    if (fine) continue;
    const Body& body = state.bodies[state.particles.body[i]];
    throw SimulationDiverged(
        fmt::format("the simulation diverged at t = {:.6g} s: body '{}', particle {} is no longer finite "
                    "or is stretched beyond "
                    "{:g} times; lower [solver] step_fraction (now {:g}), or soften what drives it",
                    state.time, body.name, i - body.particles.begin, exploded, step_fraction));
  }
}

void refuse_energy(const State& state, double step_fraction) {
  const std::size_t i = most_energetic(state);
  const Body& body = state.bodies[state.particles.body[i]];
  throw SimulationDiverged(fmt::format(
      "the simulation went wrong by t = {:.6g} s: it has gained several times the energy that was put "
      "in, most of it now at body '{}', particle {}; lower [solver] step_fraction (now {:g}), or soften "
      "what drives it",
      state.time, body.name, i - body.particles.begin, step_fraction));
}

void refuse_step(const State& state, double step) {
  const std::size_t i = most_energetic(state);
  const Body& body = state.bodies[state.particles.body[i]];
  throw SimulationDiverged(fmt::format(
      "the simulation cannot go on at t = {:.6g} s: its stable step has fallen to {:.3g} s; "
      "something moves (fastest: body '{}', particle {}) or is stiff beyond reason: look at loads, "
      "velocities, 'young' and contact 'stiffness'",
      state.time, step, body.name, i - body.particles.begin));
}

}  // namespace deforma
