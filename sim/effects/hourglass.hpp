#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Hourglass control: stiffness against what the least-squares gradient does not see, such as a checkerboard
/// motion.
///     E_hg = 1/2 sum_i sum_j c_ij |grad u_i X_ij - u_ij|^2,   c_ij = zeta E V_i W_ij / tr(A_i)
/// The weighted fit makes sum_j c_ij e_ij X_ij^T zero, so that the pair force alone is the exact gradient. With the
/// quadratic fit the residual is u_ij - (grad u_i + grad u_j) X_ij / 2, blind to bending (sim/internal_force.hpp).
/// Needs an elastic material, whose Young's modulus E sets the scale.
const EffectInfo& hourglass_effect();

}  // namespace deforma
