#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/divergence.hpp"
#include "sim/effect.hpp"
#include "sim/ledger.hpp"
#include "sim/state.hpp"
#include "sim/statistics.hpp"

namespace deforma {

/// Both take one force a substep. Velocity Verlet is second order and keeps energy when the substep changes, as it
/// does at every impact; symplectic Euler is the paper's (eqs 22-24, with the new velocity in the last).
enum class Integrator { symplectic_euler, velocity_verlet };

struct SolverSettings {
  Integrator integrator = Integrator::velocity_verlet;
  double step_fraction = 0.7;  ///< of the measured stability limit
  double max_step = 0.0;       ///< upper bound of the substep [s]; 0: none
};

/// Advances a state in time with the effects it was given.
class Solver {
 public:
  /// @throws std::invalid_argument when a setting is out of range: the message names it.
  Solver(State state, std::vector<std::unique_ptr<Effect>> effects, const SolverSettings& settings);
  ~Solver();

  /// Simulates `seconds` more in stable substeps.
  /// @throws SimulationDiverged with the time, body, particle and the setting to change.
  void advance(double seconds);

  /// The largest stable step now, times the step fraction [s].
  double stable_step();

  /// The whole surface as drawn [m], one point per vertex; up to date with the state.
  void deform(std::span<Vec3> points) const;

  /// The force of every effect on particles at rest at other places than the state's [N], at the state's time; zero
  /// where particles are fixed. The state is not changed, but contacts may forget what they remember: friction
  /// held, and how deep they began.
  /// @param displacement of every particle, fixed ones too [m]    n
  /// @param force        written                                  n
  /// @throws std::invalid_argument when the lengths differ from the number of particles.
  void static_force(std::span<const Vec3> displacement, std::span<Vec3> force);

  /// What an equilibrium at the present place has to balance [N], as a 2-norm: the forces on free particles that do
  /// not answer strain, or those that hold the fixed ones, whichever is larger.
  double applied_load();

  /// Puts the free particles elsewhere, at rest; pins place what they hold.
  /// @param displacement of every particle [m]                    n
  /// @throws std::invalid_argument when the length differs from the number of particles.
  void place(std::span<const Vec3> displacement);

  const State& state() const;
  Ledger ledger() const;
  const SolverStatistics& statistics() const;
  std::span<const std::unique_ptr<Effect>> effects() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace deforma
