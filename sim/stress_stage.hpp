#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/blocks.hpp"
#include "sim/effect.hpp"
#include "sim/internal_force.hpp"
#include "sim/state.hpp"
#include "sim/statistics.hpp"
#include "sim/step_control.hpp"

namespace deforma {

/// From displacements to the stress that the neighbours will gather, block by block: the deformation gradients of a
/// block, what every effect answers to them, and where it is put for the gather, while all of it is in the cache.
class StressStage {
 public:
  StressStage() = default;
  /// @param needs of all effects together
  StressStage(const State& state, std::span<const std::unique_ptr<Effect>> effects, unsigned needs);

  /// Where the time of a pass goes.
  struct Times {
    SolverStatistics::Pass& strain;
    SolverStatistics::Pass& carry;
    std::span<SolverStatistics::Pass> effects;
  };

  /// Finds F, and its rate where some effect needs it, at the state's displacements.
  /// @param last_step   that the F there is lies behind [s]; 0: it tells nothing of the rate
  /// @param with_stress whether to carry the stress as well
  /// @param control     told of the strain
  void find_strain(State& state, double last_step, bool with_stress, StepControl& control, Times times);

  /// Carries the stress that belongs to the state's F.
  /// @param P            what surface forces have left [Pa], n; or empty for none. Effects add to it.
  /// @param with_effects false: P alone
  void carry(const State& state, std::span<Mat3> P, bool with_effects, Times times);

  /// The force that answers strain alone, without its rate, at other displacements than the state's [N].
  /// @param displacement [m]      n
  /// @param force        written  n
  void answer(const State& state, std::span<const Vec3> displacement, std::span<Vec3> force);

  /// Gathers what was carried.
  /// @param force added to [N]    n
  void add_force(const State& state, std::span<Vec3> force) { internal_.add_to(force, state); }

  std::size_t bytes() const { return internal_.bytes(); }

 private:
  class Clock;

  std::vector<Block> blocks_;
  std::vector<Effect*> effects_;     // that stress
  std::vector<std::size_t> places_;  // of these among all effects
  unsigned needs_ = 0;
  InternalForce internal_;
  std::vector<StrainSurvey> surveys_;  // of each block
};

}  // namespace deforma
