#include "sim/motion.hpp"

#include <utility>

namespace deforma {

void Motion::rest_at(std::span<const Vec3> elsewhere, const State& state) {
  displacement.assign(elsewhere.begin(), elsewhere.end());
  velocity.assign(state.size(), Vec3::Zero());
  F.resize(state.F.size());
  F_rate.assign(state.F_rate.size(), Mat3::Zero());
  position.resize(state.surface.position.size());
  surface_velocity.resize(state.surface.velocity.size());
}

void Motion::exchange(State& state) {
  std::swap(state.particles.displacement, displacement);
  std::swap(state.particles.velocity, velocity);
  std::swap(state.F, F);
  std::swap(state.F_rate, F_rate);
  std::swap(state.surface.position, position);
  std::swap(state.surface.velocity, surface_velocity);
}

}  // namespace deforma
