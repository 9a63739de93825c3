#pragma once

#include <Eigen/SparseCholesky>
#include <span>
#include <vector>

#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// The diagonal of the box around some points [m]; 0 for none.
double extent(std::span<const Vec3> points);

/// A network of springs between near particles of a body, which answers displacements much as the body does: what
/// iterations on the real force are preconditioned with.
///
/// Springs join what is closer than 1.75 times the mean distance of the six nearest and have k = E V / 2 r^2. The
/// system is solved approximately by one symmetric cycle on two levels: block Gauss-Seidel on the particles, and
/// exactly on aggregates of about 27 particles, which move rigidly each (Vanek, Mandel & Brezina, Computing 56 (1996),
/// their prolongation unsmoothed). The coarse level sees the bending of slender bodies, so that the number of
/// iterations does not grow with slenderness.
class SpringNetwork {
 public:
  explicit SpringNetwork(const State& state);

  /// Takes the springs' directions from where particles are. A body of which nothing is fixed is held by weak springs,
  /// stiffness per mass E/100 rho L^2, at every particle.
  /// @param displacement u [m]                                    n
  void assemble(const State& state, std::span<const Vec3> displacement);

  /// The displacement with which the network answers a force, approximately; symmetric and positive definite.
  /// @param force    [N]                                          n
  /// @param answer   written, 0 where particles are fixed [m]     n
  void solve(std::span<const Vec3> force, std::span<Vec3> answer) const;

  /// The largest change of a spring's vector over its length.
  /// @param change of the displacement, from where `assemble` saw the particles [m]   n
  double steepness(std::span<const Vec3> change) const;

  /// Follows a small displacement further than it is meant to be followed: each neighbourhood turns by the finite
  /// rotation of which the displacement has the first order, and the places are found that fit these best. Source: as
  /// in Sorkine & Alexa, As-rigid-as-possible surface modeling (2007), the second of their two steps.
  /// @param change of the displacement, from where `assemble` saw the particles [m]; rewritten   n
  void turn(std::span<Vec3> change) const;

 private:
  struct Spring {
    Index j;
    double stiffness;  // [N/m]
    Vec3 arm;          // x_ij now [m]
    Vec3 pull;         // sqrt(stiffness) times its direction
  };
  using Basis = Eigen::Matrix<double, 3, 6>;

  void aggregate(const State& state);
  void find_bases(const State& state, std::span<const Vec3> displacement);
  void factor_coarse();
  Range row(std::size_t i) const { return {start_[i], start_[i + 1]}; }

  std::vector<Index> start_;
  std::vector<Spring> springs_;  // both directions of every pair
  std::vector<double> hold_;     // of every body while nothing of it is fixed [1/s^2]
  std::vector<std::uint8_t> fixed_;
  std::vector<Mat3> ground_,
      inverse_;               // what holds a particle without neighbours; inverse of the diagonal block
  std::vector<Index> group_;  // aggregate of every particle
  Index groups_ = 0;
  std::vector<Basis> basis_;   // how each particle moves with its aggregate's coordinates
  std::vector<int> rank_;      // how many of these an aggregate has
  std::vector<Index> column_;  // where they begin
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarse_;
};

}  // namespace deforma
