#pragma once

#include <span>

#include "sim/moving_least_squares.hpp"
#include "sim/neighborhood.hpp"
#include "sim/particles.hpp"
#include "sim/types.hpp"

namespace deforma {

/// What a particle's stress does to its neighbors, ready for the gather: B_i = V_i P_i inverse_i^T [N] with
/// the linear fit, V_i P_i [N m] with the quadratic one.
///
/// Where hourglass control gives a stiffness s_i, c_ij = s_i W_ij, what the fit does not explain is penalised.
/// Linear: e_ij = grad u_i X_ij - u_ij; the affine part of its force is folded in, B_i -= s_i l_i grad u_i, and
/// the pair part is left to the gather. Quadratic: the trapezoid residual
/// e_ij = u_ij - (grad u_i + grad u_j) X_ij / 2, which vanishes for quadratic fields; with c = c_ij + c_ji all
/// of it is done here, f_i += sum_j c e_ij and B_i -= 1/2 sum_j c e_ij X_ij^T.
///
/// @param displacement u [m]                                    n
/// @param F  deformation gradients                              n
/// @param P  first Piola-Kirchhoff stress [Pa]                  n
/// @param pair_stiffness s [N/m], or empty without hourglass control
/// @param B  written                                            n
/// @param force added to, never cleared [N]                     n
void carried_stress(const Particles& particles, const Neighborhood& links, const MovingLeastSquares& fit,
                    std::span<const Vec3> displacement, std::span<const Mat3> F, std::span<const Mat3> P,
                    std::span<const double> pair_stiffness, std::span<Mat3> B, std::span<Vec3> force);

/// Adds the force with which every particle's neighborhood answers its stress.
///
/// The exact negative gradient of the strain energy, gathered by the particle that receives it:
///     linear:     f_i += sum_j (B_i + B_j) (W X)_ij  +  (s_i + s_j) W_ij (u_j - u_i)
///     quadratic:  f_i += sum_j B_i g_ij - B_j g_ji
/// Swapping i and j flips the sign, so momentum is kept; row i writes only f_i, so rows run in any order with
/// one result. Source: Mueller et al. 2004, section 4 (paper eq 17 with the reaction it leaves out).
///
/// @param B     from `carried_stress`                           n
/// @param pair_stiffness s [N/m], or empty without hourglass control
/// @param displacement u [m]                                    n
/// @param force added to, never cleared [N]                     n
/// @throws std::invalid_argument when the lengths differ.
void add_internal_force(const Neighborhood& links, const MovingLeastSquares& fit, std::span<const Mat3> B,
                        std::span<const double> pair_stiffness, std::span<const Vec3> displacement,
                        std::span<Vec3> force);

}  // namespace deforma
