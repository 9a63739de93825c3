#pragma once

#include <span>
#include <string_view>

#include "sim/inner_loops.hpp"
#include "sim/types.hpp"

namespace deforma {

/// How a solid answers its deformation gradient. All reduce to Hooke's law with the same Lamé constants at
/// small strain.
enum class Material {
  neo_hookean,          ///< inversion-safe: finite and polynomial for every F (family of Smith et al. 2018)
  st_venant_kirchhoff,  ///< the paper's (eqs 4, 5), with the factor 1/2 that its strain lacks; blind to
                        ///< reflection
  corotated             ///< fixed corotated: linear in F away from its rotation
};

/// @throws std::invalid_argument for a name that is no material; the message lists the names.
Material material_from_name(std::string_view name);
std::span<const std::string_view> material_names();

/// Lamé's constants [Pa].
struct Lame {
  double lambda;
  double mu;

  double p_wave_modulus() const { return lambda + 2.0 * mu; }
};

/// @param young Young's modulus [Pa], positive
/// @param poisson Poisson's ratio, in (-1, 0.5)
Lame lame_constants(double young, double poisson);

/// Strain energy density Psi(F) [J/m^3]; zero at rest.
double energy_density(Material material, const Lame& lame, const Mat3& F);

/// First Piola-Kirchhoff stress P = dPsi/dF [Pa].
Mat3 first_piola_kirchhoff(Material material, const Lame& lame, const Mat3& F);

/// The same of many deformation gradients, added to P. Both of one length.
void add_first_piola_kirchhoff(Material material, const Lame& lame, std::span<const Mat3> F,
                               std::span<Mat3> P, const InnerLoops& loops);

/// The same for a neighbourhood that spans only a plane (rank 2: plane stress) or a line (rank 1: axial
/// stress), with Q the projector onto it and F = F Q: St.Venant-Kirchhoff in E_G = (F^T F - Q)/2. Zero for
/// rank 0.
double reduced_energy_density(const Lame& lame, const Mat3& F, const Mat3& Q, int rank);
Mat3 reduced_first_piola_kirchhoff(const Lame& lame, const Mat3& F, const Mat3& Q, int rank);

/// Cofactor matrix det(F) F^-T, defined for singular F too.
inline Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  for (int c = 0; c < 3; ++c) {  // column c is the cross product of the two that follow it
    const double *const a = F.data() + 3 * ((c + 1) % 3), *const b = F.data() + 3 * ((c + 2) % 3);
    C(0, c) = a[1] * b[2] - a[2] * b[1];
    C(1, c) = a[2] * b[0] - a[0] * b[2];
    C(2, c) = a[0] * b[1] - a[1] * b[0];
  }
  return C;
}

/// The rotation nearest to F: from its singular value decomposition, the smallest singular direction flipped
/// where that is needed for determinant +1.
Mat3 nearest_rotation(const Mat3& F);

}  // namespace deforma
