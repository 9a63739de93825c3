#pragma once

#include <stdexcept>

#include "sim/state.hpp"

namespace deforma {

/// Thrown when a run goes wrong: the state is no longer finite, is stretched beyond reason, or its step vanishes.
class SimulationDiverged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A deformation gradient this large is no deformation any more.
inline constexpr double exploded = 100.0;

/// @param finite_strain whether every F is known to be finite and below `exploded`: then they are not looked at
/// @param step_fraction the setting to change, for the message
/// @throws SimulationDiverged with time, body and particle when some state is not finite or some F has exploded.
void refuse_divergence(const State& state, bool finite_strain, double step_fraction);

/// @throws SimulationDiverged with the time and the particle with the most kinetic energy: the run has gained energy
///         that nothing put in.
[[noreturn]] void refuse_energy(const State& state, double step_fraction);

/// @param step that is left [s]
/// @throws SimulationDiverged with the time and the particle with the most kinetic energy: at such steps it will never
///         get there.
[[noreturn]] void refuse_step(const State& state, double step);

}  // namespace deforma
