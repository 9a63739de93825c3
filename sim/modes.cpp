#include "sim/modes.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "sim/spring_network.hpp"

namespace deforma {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nudge = 2e-5;      // of a spring's length, for central differences of the force
constexpr double dependent = 1e-9;  // directions of a block with less of the largest, squared
constexpr double motionless =
    1e-6;  // of the block's highest square frequency: smaller ones need not be better than this one
constexpr double safety = 0.05;  // of the tolerance: the error is estimated with the network's stiffness
constexpr int smoothing = 3;     // answers of the network that the first block has gone through
constexpr int restart = 20;      // iterations after which rounding has gathered in the block
constexpr Eigen::Index least_guard = 7;

Eigen::Index size_of(const State& state) { return static_cast<Eigen::Index>(state.size()); }

// A block's column as displacements of particles.
std::span<Vec3> field_of(MatrixXd& block, Eigen::Index column) {
  return {reinterpret_cast<Vec3*>(block.col(column).data()), static_cast<std::size_t>(block.rows() / 3)};
}

/// Stiffness, mass and preconditioner about one state.
class Problem {
 public:
  explicit Problem(Solver& solver)
      : solver_(solver), network_(solver.state()), place_(solver.state().particles.displacement) {
    const State& state = solver.state();
    mass_ = VectorXd::Zero(3 * size_of(state));
    for (std::size_t i = 0; i < state.size(); ++i)
      if (!state.fixed[i])
        mass_.segment<3>(static_cast<Eigen::Index>(3 * i)).setConstant(state.particles.mass[i]);
    for (Index i = 0; i < state.size(); ++i) find_freedom(i);
    there_.resize(state.size());
    ahead_.resize(state.size());
    behind_.resize(state.size());
    network_.assemble(state, place_);
    size_ = extent(state.particles.rest);
  }

  const VectorXd& mass() const { return mass_; }
  Eigen::Index freedoms() const { return freedoms_; }

  /// Leaves of every motion what belongs to a mode: nothing where particles are held, and what strain answers elsewhere.
  void restrict(std::span<Vec3> field) const {
    for (std::size_t i = 0; i < field.size(); ++i)
      if (mass_[static_cast<Eigen::Index>(3 * i)] == 0.0) field[i].setZero();
    for (const auto& [i, projector] : thin_) field[i] = projector * field[i];
  }

  MatrixXd stiffness(MatrixXd block) {
    for (Eigen::Index k = 0; k < block.cols(); ++k) multiply(field_of(block, k));
    return block;
  }

  MatrixXd precondition(const MatrixXd& block) {
    MatrixXd answer(block.rows(), block.cols());
    for (Eigen::Index k = 0; k < block.cols(); ++k) {
      for (std::size_t i = 0; i < place_.size(); ++i)
        there_[i] = block.col(k).segment<3>(static_cast<Eigen::Index>(3 * i));
      network_.solve(there_, field_of(answer, k));
      restrict(field_of(answer, k));
    }
    return answer;
  }

 private:
  void multiply(std::span<Vec3> field) {
    double reach = 0.0;
    for (const Vec3& v : field) reach = std::max(reach, v.norm());
    const double steepness = std::max(network_.steepness(field), size_ > 0.0 ? reach / size_ : reach);
    if (!(steepness > 0.0)) return;
    const double scale = nudge / steepness;
    for (std::size_t i = 0; i < field.size(); ++i) there_[i] = place_[i] + scale * field[i];
    solver_.static_force(there_, ahead_);
    for (std::size_t i = 0; i < field.size(); ++i) there_[i] = place_[i] - scale * field[i];
    solver_.static_force(there_, behind_);
    for (std::size_t i = 0; i < field.size(); ++i) field[i] = (behind_[i] - ahead_[i]) / (2.0 * scale);
    restrict(field);
  }

  // In a sheet or a rope a particle moves within it.
  void find_freedom(Index i) {
    const State& state = solver_.state();
    if (state.fixed[i]) return;
    const int rank = state.F.empty() ? 3 : state.fit.rank[i];
    freedoms_ += rank == 0 ? 3 : rank;
    if (rank == 0 || rank == 3) return;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(state.F[i] * state.F[i].transpose());
    const auto within = eigen.eigenvectors().rightCols(rank);
    thin_.emplace_back(i, within * within.transpose());
  }

  Solver& solver_;
  SpringNetwork network_;
  std::vector<Vec3> place_, there_, ahead_, behind_;
  double size_ = 0.0;
  VectorXd mass_;
  std::vector<std::pair<Index, Mat3>> thin_;  // projectors onto what a sheet or rope spans now
  Eigen::Index freedoms_ = 0;
};

// The combinations of a block's columns that are orthonormal by mass; what depends on others is left out.
MatrixXd orthonormal(const MatrixXd& block, const VectorXd& mass) {
  const MatrixXd gram = block.transpose() * (mass.asDiagonal() * block);
  const VectorXd scale = gram.diagonal().unaryExpr(
      [](double squared) { return squared > 0.0 ? 1.0 / std::sqrt(squared) : 0.0; });
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * gram * scale.asDiagonal());
  Eigen::Index first = 0;
  while (eigen.eigenvalues()[first] < dependent * eigen.eigenvalues()[gram.cols() - 1]) ++first;
  const Eigen::Index rank = gram.cols() - first;
  return scale.asDiagonal() * eigen.eigenvectors().rightCols(rank) *
         eigen.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

// Rayleigh and Ritz: in the space that `block` spans, the combinations that vibrate by themselves.
struct Ritz {
  VectorXd value;   // square angular frequencies, ascending [1/s^2]
  MatrixXd vector;  // of the block's columns
};

Ritz ritz(const MatrixXd& block, const MatrixXd& stiff, const VectorXd& mass) {
  const MatrixXd basis = orthonormal(block, mass);
  const MatrixXd reduced = basis.transpose() * (block.transpose() * stiff) * basis;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (reduced + reduced.transpose()));
  return {eigen.eigenvalues(), basis * eigen.eigenvectors()};
}

std::vector<Mode> modes_of(const VectorXd& value, const MatrixXd& shape, Eigen::Index count) {
  std::vector<Mode> modes;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double omega = std::copysign(std::sqrt(std::abs(value[k])), value[k]);
    Mode mode{omega / (2.0 * std::numbers::pi),
              std::vector<Vec3>(static_cast<std::size_t>(shape.rows() / 3))};
    for (std::size_t i = 0; i < mode.shape.size(); ++i)
      mode.shape[i] = shape.col(k).segment<3>(static_cast<Eigen::Index>(3 * i));
    modes.push_back(std::move(mode));
  }
  return modes;
}

// One column per degree of freedom: for bodies so small that a block would hardly fit.
std::vector<Mode> all_modes(Problem& problem, Eigen::Index count) {
  MatrixXd units = MatrixXd::Identity(problem.mass().size(), problem.mass().size());
  for (Eigen::Index k = 0; k < units.cols(); ++k) problem.restrict(field_of(units, k));
  const Ritz all = ritz(units, problem.stiffness(units), problem.mass());
  return modes_of(all.value, units * all.vector, count);
}

MatrixXd first_block(Problem& problem, Eigen::Index columns) {
  const VectorXd root = problem.mass().cwiseSqrt();
  const VectorXd inverse = root.unaryExpr([](double r) { return r > 0.0 ? 1.0 / r : 0.0; });
  std::mt19937 generator(5);
  MatrixXd block(problem.mass().size(), columns);
  for (Eigen::Index k = 0; k < columns; ++k)
    for (Eigen::Index dof = 0; dof < block.rows(); ++dof) block(dof, k) = generator() / 2147483648.0 - 1.0;
  for (int pass = 0; pass < smoothing; ++pass) {
    block = root.asDiagonal() * problem.precondition(problem.mass().asDiagonal() * block);
    // Not by `orthonormal`: rigid motions prevail, and what little else there is must not be left out.
    const Eigen::HouseholderQR<MatrixXd> factors(block);
    block = inverse.asDiagonal() * (factors.householderQ() * MatrixXd::Identity(block.rows(), columns));
  }
  return block;
}

void check(int count, Eigen::Index freedoms, const ModeSettings& settings) {
  if (count < 1 || count > freedoms)
    throw std::invalid_argument(fmt::format(
        "the number of modes must be in [1, {}], the free degrees of freedom, found {}", freedoms, count));
  if (!(settings.tolerance > 0.0 && settings.tolerance < 1.0))
    throw std::invalid_argument(
        fmt::format("the tolerance of natural modes must be in (0, 1), found {}", settings.tolerance));
  if (settings.most_iterations < 1)
    throw std::invalid_argument(fmt::format("the iterations to natural modes must be at least 1, found {}",
                                            settings.most_iterations));
}

}  // namespace

std::vector<Mode> natural_modes(Solver& solver, int count, const ModeSettings& settings) {
  Problem problem(solver);
  check(count, problem.freedoms(), settings);
  const Eigen::Index wanted = count, columns = wanted + std::max(least_guard, wanted / 3);
  if (5 * columns > problem.freedoms()) return all_modes(problem, wanted);

  const VectorXd& mass = problem.mass();
  MatrixXd X = first_block(problem, columns), KX = problem.stiffness(X);
  MatrixXd P(X.rows(), 0), KP(X.rows(), 0);
  Ritz found = ritz(X, KX, mass);
  X = (X * found.vector).eval();
  KX = (KX * found.vector).eval();
  VectorXd value = found.value;
  double worst = 0.0;
  for (int iteration = 0; iteration < settings.most_iterations; ++iteration) {
    const MatrixXd residual = KX - mass.asDiagonal() * X * value.asDiagonal();
    MatrixXd W = problem.precondition(residual);
    // The error of a Ritz value is the residual's square, measured with the inverse of the stiffness.
    const VectorXd error = (residual.cwiseProduct(W)).colwise().sum();
    const VectorXd scale = value.cwiseAbs().cwiseMax(motionless * value.cwiseAbs().maxCoeff());
    const VectorXd relative = error.cwiseQuotient(scale);
    worst = relative.head(wanted).maxCoeff();
    const double enough = 2.0 * safety * settings.tolerance;  // a frequency is a square root
    if (worst <= enough) return modes_of(value, X, wanted);
    std::vector<Eigen::Index> active;
    for (Eigen::Index k = 0; k < X.cols(); ++k)
      if (relative[k] > 0.1 * enough) active.push_back(k);
    W = W(Eigen::all, active).eval();
    W -= X * (X.transpose() * (mass.asDiagonal() * W));
    W = (W * orthonormal(W, mass)).eval();
    W -= X * (X.transpose() * (mass.asDiagonal() * W));
    const MatrixXd KW = problem.stiffness(W);

    MatrixXd S(X.rows(), X.cols() + W.cols() + P.cols()), KS(S.rows(), S.cols());
    S << X, W, P;
    KS << KX, KW, KP;
    found = ritz(S, KS, mass);
    const MatrixXd chosen = found.vector.leftCols(X.cols());
    const Eigen::Index fresh = W.cols() + P.cols();
    // The next direction is the step just made, without the share that stayed in the old block.
    P = S.rightCols(fresh) * chosen.bottomRows(fresh);
    KP = KS.rightCols(fresh) * chosen.bottomRows(fresh);
    P = P(Eigen::all, active).eval();
    KP = KP(Eigen::all, active).eval();
    X = S * chosen;
    KX = KS * chosen;
    value = found.value.head(X.cols());
    if ((iteration + 1) % restart != 0) continue;
    KX = problem.stiffness(X);
    P.resize(Eigen::NoChange, 0);
    KP.resize(Eigen::NoChange, 0);
  }
  throw std::runtime_error(fmt::format(
      "the {} lowest natural modes were not found in {} iterations: the worst frequency may still be "
      "wrong by {:.2g} of itself",
      count, settings.most_iterations, worst / (2.0 * safety)));
}

}  // namespace deforma
