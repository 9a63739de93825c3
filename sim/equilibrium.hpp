#pragma once

#include "sim/solver.hpp"

namespace deforma {

struct EquilibriumSettings {
  double tolerance = 1e-6;  ///< largest residual force, of the applied load (2-norms over the free particles)
  int most_iterations = 400;  ///< of Newton's method
};

/// What was reached.
struct Equilibrium {
  bool converged;
  double residual;        ///< |force on the free particles| over Solver::applied_load
  int iterations;         ///< Newton's
  int force_evaluations;  ///< of the whole world
};

/// Moves the solver's state to static equilibrium under the forces that act at its present time: large displacements
/// and rotations, pins held where they are at that time, velocities of the free particles zero.
///
/// Newton's method on Solver::static_force, the force that a run would feel; its linear systems by conjugate gradients
/// on differences of that force, preconditioned by a network of springs between near particles. Each step turns what
/// it moves by finite rotations, and goes as far as the forces do work on the way: from a state that is unstable it
/// leads away. What is found need not be the only equilibrium; large rotations of pins are best made in parts.
///
/// When it has not converged the state is the one with the smallest residual found; what has no equilibrium, such as a
/// free body under gravity, does not converge.
/// @throws std::invalid_argument when a setting is out of range: the message names it.
Equilibrium find_equilibrium(Solver& solver, const EquilibriumSettings& settings = {});

}  // namespace deforma
