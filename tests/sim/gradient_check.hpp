#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "sim/effects/registry.hpp"
#include "sim/internal_force.hpp"
#include "sim/state.hpp"

namespace deforma {

/// An effect's parameters: its defaults with some values set.
inline Parameters given(std::string_view effect,
                        std::vector<std::pair<std::string_view, SettingValue>> values = {}) {
  Parameters parameters(find_effect(effect).settings);
  for (auto& [key, value] : values) parameters.set(key, std::move(value));
  return parameters;
}

/// Brings F, near pairs and active surface vertices up to date with the displacements, as the solver does.
inline void refresh(State& state, std::span<const std::unique_ptr<Effect>> effects) {
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  for (const auto& effect : effects) effect->near(state);
  std::vector<std::uint8_t> wanted(state.surface.size(), 0);
  for (const auto& effect : effects) effect->mark(state, wanted);
  state.surface.active.clear();
  for (Index s = 0; s < wanted.size(); ++s) {
    if (!wanted[s]) continue;
    state.surface.active.push_back(s);
    state.surface.position[s] = skinned_point(state.surface.skin, s, state.surface.rest[s],
                                              state.particles.displacement, state.F, state.fit);
  }
}

/// The stress of some effects together at the state's F, as the solver asks for it.
inline void add_stress(const State& state, std::span<const std::unique_ptr<Effect>> effects,
                       std::span<Mat3> P, std::span<double> pair_stiffness) {
  for (const Block& block : make_blocks(state.bodies))
    for (const auto& effect : effects)
      effect->stress(state, block, part(state.F, block), P.subspan(block.particles.begin, block.size()),
                     pair_stiffness.subspan(block.particles.begin, block.size()));
}

/// The force that answers a stress at the state's displacements.
inline void add_internal_force(const State& state, std::span<const Mat3> P,
                               std::span<const double> pair_stiffness, std::span<Vec3> force) {
  InternalForce internal(state, !pair_stiffness.empty());
  internal.carry(state, {0, static_cast<Index>(state.size())}, state.particles.displacement, state.F, P,
                 pair_stiffness);
  internal.add_to(force, state);
}

/// The force of some effects together at the state's displacements, by the solver's stages. Refreshes the
/// state.
inline std::vector<Vec3> total_force(State& state, std::span<const std::unique_ptr<Effect>> effects) {
  refresh(state, effects);
  std::size_t n = state.size();
  std::vector<Mat3> P(n, Mat3::Zero());
  std::vector<double> pair_stiffness(n, 0.0);
  std::vector<Vec3> force(n, Vec3::Zero()), surface_force(state.surface.size(), Vec3::Zero());
  for (const auto& effect : effects) effect->surface_force(state, surface_force);
  add_surface_force(state.surface, state.fit, surface_force, P, force);
  add_stress(state, effects, P, pair_stiffness);
  add_internal_force(state, P, pair_stiffness, force);
  for (const auto& effect : effects) effect->force(state, force);
  return force;
}

inline double total_energy(State& state, std::span<const std::unique_ptr<Effect>> effects) {
  refresh(state, effects);
  double sum = 0.0;
  for (const auto& effect : effects) sum += effect->energy(state);
  return sum;
}

/// Largest difference between the force and central differences of the energy, relative to the largest force,
/// over every third degree of freedom.
inline double gradient_error(State& state, std::span<const std::unique_ptr<Effect>> effects, double step) {
  std::vector<Vec3> force = total_force(state, effects);
  double largest = 0.0, error = 0.0;
  for (const Vec3& f : force) largest = std::max(largest, f.cwiseAbs().maxCoeff());
  for (std::size_t dof = 0; dof<3 * state.size(); dof += state.size()> 40 ? 3 : 1) {
    std::size_t i = (dof / 3 + dof) % state.size();
    double& u = state.particles.displacement[i][static_cast<Eigen::Index>(dof % 3)];
    double before = u;
    // Fourth-order differences: the truncation error of the plain ones is not small against 1e-6.
    double slope = 0.0;
    for (auto [times, weight] : {std::pair{-2, 1.0}, {-1, -8.0}, {1, 8.0}, {2, -1.0}}) {
      u = before + times * step;
      slope += weight * total_energy(state, effects);
    }
    u = before;
    slope /= 12.0 * step;
    error = std::max(error, std::abs(-slope - force[i][static_cast<Eigen::Index>(dof % 3)]));
  }
  refresh(state, effects);
  EXPECT_GT(largest, 0.0) << "no force to compare";
  return error / largest;
}

/// Displaces every particle by up to `amount` [m] in each direction, always the same way.
inline void scramble(State& state, double amount, unsigned seed = 11) {
  std::mt19937 generator(seed);
  for (Vec3& u : state.particles.displacement)
    for (int axis = 0; axis < 3; ++axis) u[axis] += (generator() / 2147483648.0 - 1.0) * amount;
}

}  // namespace deforma
