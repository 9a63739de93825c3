#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/reference_kernel.hpp"
#include "sim/state.hpp"

namespace deforma {

/// What the reference loop simulates with.
struct ReferenceMaterial {
  double young = 1e5;      ///< [Pa]
  double poisson = 0.3;    ///< -
  double hourglass = 1.0;  ///< zeta; 0: none
};

/// The solid written down as its equations stand, on one thread: what the program's own speed is divided by.
///
/// Every link has its gradient vector g_ij ready (24 bytes and an index) and its stiffness (8 bytes); one pass finds F and
/// the neo-Hookean stress, one adds f_i += T g, f_j -= T g and, with the linear fit, the pair forces of hourglass control;
/// the quadratic fit has a pass of its own for its residual between them. Symplectic Euler follows. It takes the AVX2 of
/// the processor as the program itself does, but has no layout made for it. Its forces are the program's to rounding, for
/// bodies in no field, that nothing holds.
class ReferenceLoop {
 public:
  enum class Code {
    best,      ///< `portable`, compiled for AVX2 where the processor has it
    portable,  ///< over plain arrays, the sums of a row in variables of their own
    eigen      ///< the same with Eigen's vectors and matrices, straight from the equations
  };

  /// @param state of `neo_hookean` bodies of one material; its motion is where the loop begins
  /// @throws std::invalid_argument for a particle whose neighbours do not span space.
  ReferenceLoop(const State& state, const ReferenceMaterial& material);
  ReferenceLoop(const ReferenceLoop&) = delete;
  ReferenceLoop& operator=(const ReferenceLoop&) = delete;

  /// @param displacement [m]        n
  /// @param force        written [N]  n
  void find_force(std::span<const Vec3> displacement, std::span<Vec3> force, Code code = Code::best);

  /// @param dt [s], below the stability limit
  void advance(int steps, double dt, Code code = Code::best);

  std::vector<Vec3> displacement() const;  ///< [m]        n

  /// That one step reads and writes, if nothing but a row stays in the cache.
  std::size_t bytes_per_step() const;

 private:
  void link(const State& state, const ReferenceMaterial& material);

  std::vector<std::uint32_t> start_, j_;
  std::vector<double> g_, c_, rest_, mass_, weight_, u_, v_, gradient_, carried_, force_;
  ReferenceArrays arrays_;
};

}  // namespace deforma
