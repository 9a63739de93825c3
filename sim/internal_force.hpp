#pragma once

#include <span>
#include <vector>

#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// The force with which every particle's neighborhood answers its stress: first each particle's stress is put where
/// its neighbours will gather it (`carry`), block by block while it is still in the cache, then they do (`add_to`).
///
/// The exact negative gradient of the strain energy and of hourglass control, gathered by the particle that receives
/// it. With B_i = V_i P_i A_i^-T (linear fit) or V_i P_i (quadratic):
///     linear:     f_i += sum_j (B_i + B_j) W X_ij
///     quadratic:  f_i += sum_j B_i g_ij - B_j g_ji
/// Swapping i and j flips the sign, so momentum is kept; row i writes only f_i, so rows run in any order with
/// one result. Source: Mueller et al. 2004, section 4 (paper eq 17 with the reaction it leaves out).
///
/// Where hourglass control gives a stiffness s_i, c_ij = s_i W_ij, what the fit does not explain is penalised.
/// Linear: e_ij = grad u_i X_ij - u_ij; the affine part of its force is folded into B_i -= s_i grad u_i, and the pair
/// part (s_i + s_j) W u_ij rides in the same gather. Quadratic: the trapezoid residual
/// e_ij = u_ij - (grad u_i + grad u_j) X_ij / 2, which vanishes for quadratic fields; with c = c_ij + c_ji a gather of
/// its own adds f_i += sum_j c e_ij and B_i -= 1/2 sum_j c e_ij X_ij^T.
class InternalForce {
 public:
  InternalForce() = default;
  /// @param hourglass whether pair stiffnesses will be given
  InternalForce(const State& state, bool hourglass);

  /// Takes the stress of some particles; of different ones from several threads at once.
  /// @param displacement   u [m], of all particles                                          n
  /// @param F              deformation gradients of these particles
  /// @param P              their first Piola-Kirchhoff stress [Pa]
  /// @param pair_stiffness their s [N/m]; or empty without hourglass control
  /// @throws std::invalid_argument when the lengths differ.
  void carry(const State& state, Range particles, std::span<const Vec3> displacement, std::span<const Mat3> F,
             std::span<const Mat3> P, std::span<const double> pair_stiffness);

  /// Gathers what was carried for every particle.
  /// @param force added to, never cleared [N]                                               n
  /// @throws std::invalid_argument when the length differs from the number of particles.
  void add_to(std::span<Vec3> force, const State& state);

  std::size_t bytes() const;

 private:
  void carry_residuals(const State& state, std::span<Vec3> force);

  std::vector<Carrier> carriers_;   // lines: rows of B
  std::vector<Carrier> residuals_;  // for the trapezoid residual, lines: columns of grad u
};

}  // namespace deforma
