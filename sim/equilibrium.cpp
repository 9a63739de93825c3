#include "sim/equilibrium.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim/spring_network.hpp"

namespace deforma {

namespace {

using Field = std::vector<Vec3>;

constexpr double steepest = 0.7;        // change of a spring in one step, over its length
constexpr double nudge = 1e-7;          // of a spring's length, for differences of the force
constexpr double worth_turning = 1e-3;  // a step that turns by less is as good as straight
constexpr double loosest = 0.05;        // relative residual of the linear systems
constexpr double tightest = 1e-4;
constexpr int most_products = 200;  // for one linear system
constexpr int most_halvings = 10;
constexpr int patience = 25;       // iterations that bring nothing
constexpr double better = 0.9;     // a residual that is worth something, of the best so far
constexpr double further = 1e-4;   // a fall of the energy that is worth something, of all so far
constexpr double farthest = 20.0;  // how far what nothing holds may go, in sizes of everything

double dot(const Field& a, const Field& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

double largest(const Field& field) {
  double squared = 0.0;
  for (const Vec3& v : field) squared = std::max(squared, v.squaredNorm());
  return std::sqrt(squared);
}

class Search {
 public:
  explicit Search(Solver& solver)
      : solver_(solver), network_(solver.state()), place_(solver.state().particles.displacement) {
    const std::size_t n = place_.size();
    for (Field* field :
         {&force_, &step_, &residual_, &answer_, &direction_, &product_, &trial_, &trial_force_})
      field->assign(n, Vec3::Zero());
    start_ = place_;
    size_ = extent(solver.state().particles.rest);
    evaluate(place_, force_);
  }

  int evaluations() const { return evaluations_; }
  const Field& place() const { return place_; }
  double residual() const { return std::sqrt(dot(force_, force_)); }
  bool gone() const { return largest(place_) > farthest * size_ + largest(start_); }
  /// Whether the last step brought the energy down, and went where it was meant to.
  bool falls() const { return solved_ && last_fall_ > further * fall_; }

  /// One Newton step, as far along as the energy falls.
  void advance(double accuracy) {
    network_.assemble(solver_.state(), place_);
    solve_linear(accuracy);
    const double steepness = network_.steepness(step_), reach = largest(step_);
    double share = 1.0;
    if (steepness > steepest) share = steepest / steepness;
    if (reach * share > size_) share = size_ / reach;  // what nothing holds would go anywhere
    for (int halving = 0; halving <= most_halvings; ++halving, share *= 0.5) {
      for (std::size_t i = 0; i < step_.size(); ++i) trial_[i] = share * step_[i];
      if (share * steepness > worth_turning) network_.turn(trial_);
      for (std::size_t i = 0; i < step_.size(); ++i) trial_[i] += place_[i];
      evaluate(trial_, trial_force_);
      last_fall_ = work();
      if (last_fall_ > 0.0) break;
    }
    if (!std::isfinite(dot(trial_force_, trial_force_))) return;
    fall_ += last_fall_;
    std::swap(place_, trial_);
    std::swap(force_, trial_force_);
  }

 private:
  void evaluate(const Field& place, Field& force) {
    solver_.static_force(place, force);
    ++evaluations_;
  }

  // Of the forces on the way from the place to the trial [J], by the trapezoid: what the energy falls by.
  double work() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < place_.size(); ++i)
      sum += 0.5 * (force_[i] + trial_force_[i]).dot(trial_[i] - place_[i]);
    return sum;
  }

  // Preconditioned conjugate gradients for the step; stopped where the stiffness is not positive, with what there is.
  void solve_linear(double accuracy) {
    std::fill(step_.begin(), step_.end(), Vec3::Zero());
    residual_ = force_;
    network_.solve(residual_, answer_);
    direction_ = answer_;
    double size = dot(residual_, answer_);
    const double enough = accuracy * accuracy * size;
    solved_ = true;
    for (int k = 0; size > enough; ++k) {
      if (k == most_products) {
        solved_ = false;
        return;
      }
      const double reach = largest(direction_);
      const double scale = nudge / std::max(network_.steepness(direction_), reach / size_);
      for (std::size_t i = 0; i < trial_.size(); ++i) trial_[i] = place_[i] + scale * direction_[i];
      evaluate(trial_, trial_force_);
      for (std::size_t i = 0; i < product_.size(); ++i) product_[i] = (force_[i] - trial_force_[i]) / scale;
      const double curvature = dot(direction_, product_);
      if (!(curvature > 0.0)) {
        if (k == 0) step_ = direction_;
        return;
      }
      const double length = size / curvature;
      for (std::size_t i = 0; i < step_.size(); ++i) {
        step_[i] += length * direction_[i];
        residual_[i] -= length * product_[i];
      }
      network_.solve(residual_, answer_);
      const double before = size;
      size = dot(residual_, answer_);
      for (std::size_t i = 0; i < step_.size(); ++i)
        direction_[i] = answer_[i] + size / before * direction_[i];
    }
  }

  Solver& solver_;
  SpringNetwork network_;
  double size_ = 0.0;                    // of everything [m]
  double fall_ = 0.0, last_fall_ = 0.0;  // of the energy [J]
  bool solved_ = false;                  // the linear system, within the products allowed
  int evaluations_ = 0;
  Field start_;
  Field place_, force_;                                   // now
  Field step_, residual_, answer_, direction_, product_;  // of the linear system
  Field trial_, trial_force_;
};

void check(const EquilibriumSettings& settings) {
  if (!(settings.tolerance > 0.0 && settings.tolerance < 1.0))
    throw std::invalid_argument(
        fmt::format("the tolerance of an equilibrium must be in (0, 1), found {}", settings.tolerance));
  if (settings.most_iterations < 1)
    throw std::invalid_argument(fmt::format("the iterations to an equilibrium must be at least 1, found {}",
                                            settings.most_iterations));
}

}  // namespace

Equilibrium find_equilibrium(Solver& solver, const EquilibriumSettings& settings) {
  check(settings);
  solver.place(Field(solver.state().particles.displacement));
  Search search(solver);
  Equilibrium result{false, 0.0, 0, 0};
  const double at_first = search.residual();
  int loads = 0;
  double best = std::numeric_limits<double>::infinity(), milestone = best, before = at_first;
  Field best_place = search.place();
  int waited = 0;
  while (true) {
    const double left = search.residual();
    double load = solver.applied_load();
    loads += 2;
    if (!(load > 0.0)) load = at_first;  // nothing acts: what the present displacement answers with
    result.residual = left == 0.0 ? 0.0 : left / load;
    if (result.residual < best) {
      best = result.residual;
      best_place = search.place();
    }
    result.converged = result.residual <= settings.tolerance;
    waited = best < better * milestone || search.falls() ? 0 : waited + 1;
    if (best < better * milestone) milestone = best;
    if (result.converged || result.iterations == settings.most_iterations || waited > patience ||
        search.gone())
      break;
    search.advance(std::clamp(0.5 * left / before, tightest, loosest));
    before = left;
    ++result.iterations;
    solver.place(search.place());
  }
  solver.place(best_place);
  result.residual = best;
  result.force_evaluations = search.evaluations() + loads;
  return result;
}

}  // namespace deforma
