#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "sim/blocks.hpp"
#include "sim/effect.hpp"
#include "sim/state.hpp"
#include "sim/stiffness.hpp"

namespace deforma {

/// What the strain of some particles asks of the step.
struct StrainSurvey {
  /// How much stiffer than at rest some material can have become, but for a constant: what multiplies the moduli in the
  /// second derivatives of the energies in use, 1/2 + |F|^2 + |cof F|^2 + |det F - 1| |F|. The norm of F alone would not
  /// tell a pulled particle from a flattened one, whose cofactors are many times larger. Infinity where some F is not
  /// finite or exploded.
  double stiffening = 0.0;
  double change = 0.0;  ///< the largest |F - F_before|^2 over |F|^2 or 1

  /// @param F, F_before of the same particles, now and one step ago
  void look(std::span<const Mat3> F, std::span<const Mat3> F_before, const InnerLoops& loops);
};

/// Bounds the substep as far as strain is concerned: by the highest frequency, measured on the real force and again
/// when a body's stretch or a stiffness has changed, and by how fast the strain itself changes.
class StepControl {
 public:
  StepControl() = default;
  /// @param bodies how many the world has
  explicit StepControl(std::size_t bodies);

  /// Takes note of the strain now.
  /// @param surveys   of each block, against the F of one step ago
  /// @param last_step that this lies behind [s]; 0: nothing is known of the change
  void observe(std::span<const Block> blocks, std::span<const StrainSurvey> surveys, double last_step);

  /// False when some F observed is not finite, or is no deformation any more.
  bool finite() const;

  /// The sums of all effects' stiffness keys, per body, when last asked for.
  std::span<const double> keys() const { return conditions_.key; }

  /// Asks the effects for their stiffness keys.
  /// @return true when the last measurement no longer holds
  bool stale(const State& state, std::span<const std::unique_ptr<Effect>> effects);

  /// Measures the highest frequency about the present displacement.
  /// @param force what answers strain alone [N] at a displacement [m]
  void measure(const State& state, const StiffnessProbe::Force& force);

  /// The largest step that strain allows [s]; infinity where nothing does. It stays while the stiffness is about the
  /// same, may shrink at once and grows slowly: a step that followed every swing of a vibration, if only by 1 %, would
  /// feed it.
  double step();

  /// A substep of the size last told begins: the next may be larger by so little only.
  void begin_substep() { step_before_ = step_; }

 private:
  StiffnessProbe probe_;
  StiffnessProbe::Conditions conditions_;  // now
  double omega_ = 0.0;                     // measured highest frequency [rad/s]
  double strain_rate_ = 0.0;               // the largest relative change of F in the last step [1/s]
  double step_ = std::numeric_limits<double>::infinity();         // [s]
  double step_before_ = std::numeric_limits<double>::infinity();  // in the last substep [s]
};

}  // namespace deforma
