#include "sim/ledger.hpp"

#include <Eigen/Geometry>

namespace deforma {

double Ledger::total() const {
  double sum = kinetic;
  for (const auto& [name, energy] : potential) sum += energy;
  return sum;
}

Ledger measure_ledger(const State& state, std::span<const std::unique_ptr<Effect>> effects) {
  Ledger ledger;
  for (std::size_t i = 0; i < state.size(); ++i) {
    Vec3 p = state.particles.mass[i] * state.particles.velocity[i];
    ledger.kinetic += 0.5 * p.dot(state.particles.velocity[i]);
    ledger.linear_momentum += p;
    ledger.angular_momentum += state.particles.position(i).cross(p);
  }
  for (const auto& effect : effects) ledger.potential.emplace_back(effect->name(), effect->energy(state));
  return ledger;
}

}  // namespace deforma
