#pragma once

#include <vector>

#include "sim/solver.hpp"

namespace deforma {

/// A natural vibration u(t) = shape cos(2 pi frequency t) of small amplitude.
struct Mode {
  double frequency;  ///< [Hz]; about 0 for a rigid motion; negative where the state is unstable and what
                     ///< grows does so as exp(2 pi |frequency| t)
  std::vector<Vec3> shape;  ///< zero where particles are held; sum_i m_i shape_i^2 = 1 kg m^2 [m]    n
};

struct ModeSettings {
  double tolerance = 1e-4;    ///< relative, of every frequency
  int most_iterations = 300;  ///< of the whole block
};

/// The lowest natural modes about the solver's present displacement, ascending, with the pins held; shapes are
/// orthogonal by mass. Particles of a one-layer sheet or a rope move within it only: what it does across is resisted
/// by no strain. The state is left as it is.
///
/// The stiffness is that of Solver::static_force, the force that a run feels, by central differences. Block method:
/// locally optimal preconditioned conjugate gradients, Knyazev, SIAM J. Sci. Comput. 23 (2001), algorithm 4.1,
/// preconditioned by the network of springs between near particles.
/// @throws std::invalid_argument when count is not in [1, free degrees of freedom] or a setting is out of range.
/// @throws std::runtime_error when the iterations do not suffice; the message says how close they came.
std::vector<Mode> natural_modes(Solver& solver, int count, const ModeSettings& settings = {});

}  // namespace deforma
