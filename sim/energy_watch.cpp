#include "sim/energy_watch.hpp"

#include <algorithm>
#include <cmath>

namespace deforma {

namespace {

constexpr double created_share = 0.9;

// Below these a change of energy is a matter of rounding: of the potentials' own sizes, and of a strain of 1e-8.
constexpr double relative_rounding = 1e-9;
constexpr double rounding_strain = 1e-8;

double rounding(const State& state, const Ledger& base) {
  double sum = base.kinetic;
  for (const auto& [name, energy] : base.potential) sum += std::abs(energy);
  double elastic = 0.0;
  for (const Body& body : state.bodies)
    elastic += body.modulus * std::pow(body.spacing, 3) * static_cast<double>(body.particles.size());
  return relative_rounding * sum + rounding_strain * rounding_strain * elastic;
}

}  // namespace

bool EnergyWatch::wants_ledger(const Particles& particles) const {
  if (!based_) return true;
  double kinetic = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i)
    kinetic += 0.5 * particles.mass[i] * particles.velocity[i].squaredNorm();
  return kinetic > 2.0 * kinetic_seen_;
}

EnergyWatch::Held EnergyWatch::held(const State& state) {
  Held held;
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (!state.fixed[i]) continue;
    held.sum += state.particles.displacement[i] *
                static_cast<double>(1 + i % 7);  // turning about the middle shows, too
    ++held.count;
  }
  return held;
}

bool EnergyWatch::driven(const State& state, std::span<const std::unique_ptr<Effect>> effects,
                         std::span<const double> stiffness_keys) const {
  const Held now = held(state);
  return now.count != held_.count || now.sum != held_.sum ||
         !std::equal(keys_.begin(), keys_.end(), stiffness_keys.begin(), stiffness_keys.end()) ||
         std::any_of(effects.begin(), effects.end(),
                     [&](const auto& effect) { return effect->driven(time_, state.time); }) ||
         std::any_of(state.bodies.begin(), state.bodies.end(),
                     [&](const Body& body) { return body.young.varies(time_, state.time); });
}

bool EnergyWatch::alarmed(const State& state, std::span<const std::unique_ptr<Effect>> effects,
                          const Ledger& ledger, std::span<const double> stiffness_keys) {
  if (!based_ || driven(state, effects, stiffness_keys)) {
    based_ = true;
    time_ = state.time;
    ledger_ = ledger;
    keys_.assign(stiffness_keys.begin(), stiffness_keys.end());
    held_ = held(state);
    kinetic_seen_ = ledger.kinetic;
    return false;
  }
  kinetic_seen_ = std::max(kinetic_seen_, ledger.kinetic);
  double exchanged = ledger.kinetic, created = ledger.kinetic - ledger_.kinetic;
  for (std::size_t k = 0; k < ledger.potential.size(); ++k) {
    const double change = ledger.potential[k].second - ledger_.potential[k].second;
    exchanged += std::abs(change);
    created += change;
  }
  return created > created_share * exchanged + rounding(state, ledger_);
}

}  // namespace deforma
