#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "sim/blocks.hpp"
#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// What an effect asks the solver to have ready; nothing is computed that no effect asks for.
enum Needs : unsigned {
  needs_nothing = 0,
  needs_strain = 1,         ///< F by one gather, and the gather of the stress into forces
  needs_strain_rate = 2,    ///< the rate of F too (implies strain)
  needs_surface = 4,        ///< positions and velocities of the surface vertices it marks (implies strain)
  needs_pair_stiffness = 8  ///< the array that `stress` writes s_i into (implies strain)
};

/// One physical effect, for all the bodies whose tables call for it. It exists only if some table does.
///
/// The stages of a substep, in the solver's order; an effect overrides those it takes part in, and is not called
/// for the others again:
///     velocity Verlet:   half kick, drift, prescribe, [ near, mark, surface_force, stress, force ], half kick, finish
///     symplectic Euler:  [ near, mark, surface_force, stress, force ], kick, drift, prescribe, finish
class Effect {
 public:
  enum Stage : unsigned { at_near, at_surface_force, at_stress, at_force, at_prescribe, at_finish };

  virtual ~Effect() = default;

  virtual std::string_view name() const = 0;
  virtual unsigned needs() const { return needs_nothing; }

  /// Refreshes what depends on time or on who is near whom. Returns true when the vertices it wants have changed.
  virtual bool near(const State&) {
    leave(at_near);
    return false;
  }

  /// Sets 1 for each surface vertex whose position it needs.                                    m
  virtual void mark(const State&, std::span<std::uint8_t>) const {}

  /// Adds forces at active surface vertices [N]; the solver carries them to the particles.      m
  virtual void surface_force(const State&, std::span<Vec3>) { leave(at_surface_force); }

  /// Adds first Piola-Kirchhoff stress [Pa] of a block's particles, a function of F and the particle alone, and, for
  /// hourglass control, the stiffness s_i [N/m] of the pair force sum_j (s_i + s_j) W_ij u_ij. All three hold the
  /// block's particles only. Called for several blocks at once, and with other F than the state's when the solver
  /// measures its stiffness; an effect that takes no part is asked once, about no particle.
  virtual void stress(const State&, const Block&, std::span<const Mat3> /*F*/, std::span<Mat3> /*P*/,
                      std::span<double> /*pair_stiffness*/) {
    leave(at_stress);
  }

  /// Adds forces on particles [N].                                                              n
  virtual void force(const State&, std::span<Vec3>) { leave(at_force); }

  /// Writes the motion of the particles it holds at the state's time, and which those are (`fixed`), before strain and
  /// forces are found there. Fixed particles are not accelerated.
  virtual void prescribe(State&) { leave(at_prescribe); }

  /// After the integration: damps, lets internal variables flow.
  virtual void finish(State&, double /*dt*/) { leave(at_finish); }

  /// False once the effect is known to take no part in a stage.
  bool takes_part(Stage stage) const { return !(left_ >> stage & 1u); }

  /// Potential energy [J]; zero for what dissipates.
  virtual double energy(const State&) const { return 0.0; }

  /// Adds, for a block's particles, the energy density [J/m^3 at rest] whose derivative by F `stress` is; nothing where
  /// there is none. May be called for several blocks at once.
  virtual void energy_density(const State&, const Block&, std::span<const Mat3> /*F*/,
                              std::span<double> /*density*/) const {}

  /// The largest stable substep as far as this effect alone knows [s]. What `stress` does in answer to F is
  /// measured by the solver itself and need not be bounded here.
  virtual double stable_step(const State&) const { return std::numeric_limits<double>::infinity(); }

  /// Adds to each body's entry a number that changes with what its stiffness depends on, such as the logarithm of its
  /// modulus: after a change of 0.05 the solver measures the stiffness again.
  virtual void stiffness_key(const State&, std::span<double> /*per body*/) const {}

  /// Whether something outside may have done work through it between two times [s]: a load, an obstacle or a depth that
  /// varied. What `stiffness_key` shows need not be told.
  virtual bool driven(double /*from*/, double /*to*/) const { return false; }

  virtual std::size_t bytes() const { return 0; }  ///< memory held

 private:
  void leave(Stage stage) { left_ |= 1u << stage; }

  unsigned left_ = 0;
};

}  // namespace deforma
