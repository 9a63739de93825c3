#pragma once

#include <cstddef>
#include <string_view>

#include "sim/link.hpp"

namespace deforma {

/// Which instructions the inner loops are made of. All add in the same order: `baseline` and `avx2` give the same bits on
/// any processor, `avx2_fma`, which rounds a product and its sum once, others by rounding.
enum class Instructions {
  baseline,  ///< what every x86-64 processor has (SSE2), or whatever this machine is
  avx2,
  avx2_fma
};

std::string_view instructions_name(Instructions instructions);

/// Whether this processor has them.
bool supports(Instructions instructions);

/// The fastest that this processor has.
Instructions fastest_instructions();

/// The fastest of those that give the same bits on every processor.
Instructions portable_instructions();

/// The rows of some particles, [begin, end): row i is links[start[i]] ... links[start[i + 1] - 1].
template <typename RowLink>
struct Rows {
  const std::uint32_t* start;
  const RowLink* links;
  const Ahead* ahead;  ///< of each row, or null: what to ask the memory for
  std::size_t begin, end;
};

/// The loops in which a simulation spends its time, on plain arrays: over neighbours and over a block's strain. Each particle gathers from its
/// neighbours and writes only what is its own, so that rows run in any order with one result. Sums run over the even
/// links and the odd ones apart, to be added at the end: two chains of additions are under way at once.
///
/// Vectors of three are three doubles and matrices nine, by columns; entry k of what is written belongs to particle
/// begin + k.
struct InnerLoops {
  /// F[k] = Q_i + (sum_j u_ij (W X_ij)^T) inverses[i] (eqs 7, 8).
  /// @param projectors Q, or null where all are the identity
  void (*linear_gradient)(const Rows<Link>& rows, const Place* places, const double* inverses,
                          const double* field, const double* projectors, double* F);

  /// F[k] = Q_i + sum_j u_ij g_ij^T.
  void (*quadratic_gradient)(const Rows<GradientLink>& rows, const double* field, const double* projectors,
                             double* F);

  /// Surveys `count` F against those of a step ago, for `StrainSurvey`: raises its two values to the largest of each.
  void (*survey)(const double* F, const double* F_before, std::size_t count, double exploded,
                 double* stiffening, double* change);

  /// Adds the first Piola-Kirchhoff stress of `Material::neo_hookean` to P, of `count` F.
  void (*neo_hookean)(double lambda, double mu, const double* F, std::size_t count, double* P);

  /// Makes carriers[k] for `linear_force`, of as many particles as are given: B = w P inverse^T - s (F - Q).
  struct Stressed {
    const Place* places;     // X
    const double* field;     // u
    const double* weights;   // w
    const double* inverses;  // of the moment matrices
    const double* stresses;  // P
    const double* F;
    const double* projectors;  // Q, or null where all are the identity
    const double* stiffness;   // s, or null
  };
  void (*linear_carry)(const Stressed& from, std::size_t count, Carrier* carriers);

  /// Adds sum_j (B_i + B_j) W X_ij + (s_i + s_j) W u_ij to force[k] (eq 17 and its reaction). A carrier holds X and s
  /// in its head and in each line a row of B and that component of u.
  void (*linear_force)(const Rows<Link>& rows, const Carrier* carriers, double* force);

  /// With e_ij = u_ij - (G_i + G_j) X_ij / 2 and c = (s_i + s_j) W: adds sum_j c e_ij to force[k] and writes
  /// moments[k] = sum_j c e_ij X_ij^T, three columns of four doubles. A carrier holds u and s in its head and in each
  /// line a column of G = grad u and that component of X.
  void (*quadratic_residual)(const Rows<Link>& rows, const Carrier* carriers, double* force, double* moments);

  /// Subtracts sum_j B_j g_ji from force[k]. The lines of a carrier hold the rows of B; rows are of g_ji.
  void (*quadratic_force)(const Rows<GradientLink>& rows, const Carrier* carriers, double* force);
};

/// @throws std::invalid_argument for instructions that this processor does not have.
const InnerLoops& inner_loops_of(Instructions instructions);

}  // namespace deforma
