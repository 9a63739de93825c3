#pragma once

#include <cstddef>
#include <cstdint>

// What the reference loop (reference_loop.hpp) runs over and again: plain arrays and nothing else, since its
// source is compiled with other machine flags than the rest and must not share an inline function with it.
namespace deforma {

/// Which residual hourglass control takes at a pair.
enum class ReferenceResidual {
  none,
  own_fit,   ///< of either side's own gradient, with c = c_ij
  trapezoid  ///< of the mean of both gradients, with c = c_ij + c_ji
};

/// One body, one array per quantity; a vector is three doubles, a matrix nine by columns.
struct ReferenceArrays {
  std::size_t particles = 0;
  const std::uint32_t* start = nullptr;  ///< row starts                                       n + 1
  const std::uint32_t* j = nullptr;      ///< the neighbour of every link
  const double* g = nullptr;             ///< of every link: grad u_i = sum_j u_ij g_ij^T [1/m]
  const double* c = nullptr;             ///< of every link, for the residual [N/m]
  ReferenceResidual residual = ReferenceResidual::none;
  const double* rest = nullptr;    ///< X [m]                                            n
  const double* mass = nullptr;    ///< [kg]                                             n
  const double* weight = nullptr;  ///< of the strain energy [m^3]                       n
  double lambda = 0.0, mu = 0.0;   ///< Lame's constants [Pa]
  double* u = nullptr;             ///< displacement [m]                                 n
  double* v = nullptr;             ///< velocity [m/s]                                   n
  double* gradient = nullptr;      ///< grad u                                           n
  double* carried = nullptr;       ///< weight times first Piola-Kirchhoff stress [J]    n
  double* force = nullptr;         ///< [N]                                              n
};

/// The force at u, written to `force`; and a step of symplectic Euler with it (eqs 22-24).
struct ReferenceKernel {
  void (*find_force)(const ReferenceArrays& body);
  void (*integrate)(const ReferenceArrays& body, double dt);
};

/// As any x86-64 runs it; for processors with AVX2 and fused multiply-add alone; and written with Eigen.
extern const ReferenceKernel reference_kernel_portable;
extern const ReferenceKernel reference_kernel_avx2;
extern const ReferenceKernel reference_kernel_eigen;

}  // namespace deforma
