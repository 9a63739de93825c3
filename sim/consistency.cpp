#include "sim/consistency.hpp"

#include <algorithm>
#include <cmath>

#include "sim/parallel.hpp"
#include "sim/triangle_tree.hpp"

namespace deforma {

namespace {

constexpr int most_iterations = 1000;
constexpr std::size_t most_corrected = 2000;  // of a body: iterations grow with their number
constexpr double wanted = 1e-13;              // of the residual at the start
constexpr double rounding = 1e-12;            // of V/d: a sum no larger is zero already

/// The system A l = r of one body's multipliers, never assembled: A l is gathered from what the fits leave over of l.
/// Its arrays begin with the body's first particle and first link.
class System {
 public:
  System(const Particles& particles, const Neighborhood& links, Range body, std::span<const Index> complete,
         std::span<const QuadraticFit> fits, std::span<const Index> reverse, const MovingLeastSquares& fit)
      : links_(links),
        first_(body.begin),
        first_link_(links.start[body.begin]),
        fits_(fits),
        reverse_(reverse),
        fit_(fit) {
    unknown_.assign(body.size(), 0);
    for (Index k : complete) unknown_[k - first_] = 1;
    const std::size_t count = links.start[body.end] - first_link_;
    per_link_.resize(count);
    // Terms are looked up in every iteration; only rows that reach an unknown have any part in it.
    terms_.resize(count);
    touched_.assign(size(), 0);
    parallel_for_each(size(), [&](std::size_t i) {
      const Range row = row_of(i);
      bool any = unknown_[i];
      for (Index l = row.begin; l < row.end && !any; ++l) any = unknown_[links.links[l].j - first_];
      touched_[i] = any && fits[first_ + i].settled();
      for (Index l = row.begin; l < row.end && touched_[i]; ++l)
        terms_[l - first_link_] =
            fits[first_ + i].terms(particles.rest[links.links[l].j] - particles.rest[first_ + i]);
    });
  }

  std::size_t size() const { return unknown_.size(); }

  // The change of V_i g_ij that the multipliers make, per link.
  const std::vector<Vec3>& change(std::span<const Vec3> multiplier) {
    parallel_for_each(size(), [&](std::size_t i) {
      const Range row = row_of(i);
      for (Index l = row.begin; l < row.end; ++l) per_link_[l - first_link_].setZero();
      if (!touched_[i]) return;
      const QuadraticFit::Square& inverse = fits_[first_ + i].inverse();
      Coefficients right = Coefficients::Zero(inverse.rows(), 3);
      for (Index l = row.begin; l < row.end; ++l) {
        const Link& link = links_.links[l];
        right += static_cast<double>(link.weight) * terms_[l - first_link_] *
                 (multiplier[link.j - first_] - multiplier[i]).transpose();
      }
      const Coefficients coefficients = inverse * right;
      const double scale = fit_.weight[first_ + i] * fit_.weight[first_ + i];
      for (Index l = row.begin; l < row.end; ++l) {
        const Link& link = links_.links[l];
        const Vec3 left =
            multiplier[link.j - first_] - multiplier[i] - coefficients.transpose() * terms_[l - first_link_];
        per_link_[l - first_link_] = scale * static_cast<double>(link.weight) * left;
      }
    });
    return per_link_;
  }

  void apply(std::span<const Vec3> multiplier, std::span<Vec3> answer) { gather(change(multiplier), answer); }

  // The present sums, with the gradients as they are.
  void present(std::span<Vec3> sum) {
    parallel_for_each(size(), [&](std::size_t i) {
      const Range row = row_of(i);
      for (Index l = row.begin; l < row.end; ++l)
        per_link_[l - first_link_] = fit_.weight[first_ + i] * gradient_vector(fit_.there[l]);
    });
    gather(per_link_, sum);
  }

  // What stands on the diagonal of A, but for the small share that the fit takes away.
  std::vector<double> diagonal() const {
    std::vector<double> sum(size(), 1.0);
    parallel_for_each(size(), [&](std::size_t k) {
      if (!unknown_[k]) return;
      sum[k] = 0.0;
      const Range row = row_of(k);
      for (Index l = row.begin; l < row.end; ++l) {
        const double own = fit_.weight[first_ + k], other = fit_.weight[links_.links[l].j];
        sum[k] += (own * own + other * other) * links_.links[l].weight;
      }
    });
    return sum;
  }

 private:
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 9, 3>;

  Range row_of(std::size_t i) const { return links_.row(first_ + i); }

  // sum_i (V_i G_ik) of what stands on the links, for the unknown k.
  void gather(const std::vector<Vec3>& on_links, std::span<Vec3> sum) const {
    parallel_for_each(size(), [&](std::size_t k) {
      sum[k].setZero();
      if (!unknown_[k]) return;
      const Range row = row_of(k);
      for (Index l = row.begin; l < row.end; ++l)
        sum[k] += on_links[reverse_[l] - first_link_] - on_links[l - first_link_];
    });
  }

  const Neighborhood& links_;
  const Index first_, first_link_;
  std::span<const QuadraticFit> fits_;
  std::span<const Index> reverse_;
  const MovingLeastSquares& fit_;
  std::vector<char> unknown_, touched_;
  std::vector<QuadraticFit::Terms> terms_;
  std::vector<Vec3> per_link_;
};

double largest(std::span<const Vec3> v) {
  double most = 0.0;
  for (const Vec3& x : v) most = std::max(most, x.cwiseAbs().maxCoeff());
  return most;
}

// The three directions are independent systems with one matrix, advanced side by side.
Vec3 dot(std::span<const Vec3> a, std::span<const Vec3> b) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].cwiseProduct(b[i]);
  return sum;
}

Vec3 ratio(const Vec3& a, const Vec3& b) {
  Vec3 r;
  for (int c = 0; c < 3; ++c) r[c] = b[c] != 0.0 ? a[c] / b[c] : 0.0;
  return r;
}

// One body's share: bodies are not linked, and their sizes may differ by powers of ten.
Consistency make_body_consistent(const Particles& particles, const Neighborhood& links, Range body,
                                 std::span<const Index> complete, std::span<const QuadraticFit> fits,
                                 std::span<const Index> reverse, MovingLeastSquares& fit) {
  Consistency result;
  const std::size_t n = body.size();
  System system(particles, links, body, complete, fits, reverse, fit);
  std::vector<Vec3> residual(n), multiplier(n, Vec3::Zero()), direction(n), answer(n), preconditioned(n);
  system.present(residual);
  for (Vec3& r : residual) r = -r;
  const double start = largest(residual);
  const double area = std::pow(fit.weight[complete.front()], 2.0 / 3.0);
  if (start <= rounding * area) return result;

  const std::vector<double> diagonal = system.diagonal();
  auto precondition = [&] {
    for (std::size_t i = 0; i < n; ++i) preconditioned[i] = residual[i] / diagonal[i];
  };
  precondition();
  direction = preconditioned;
  Vec3 energy = dot(residual, preconditioned);
  while (result.iterations < most_iterations && largest(residual) > wanted * start) {
    ++result.iterations;
    system.apply(direction, answer);
    const Vec3 step = ratio(energy, dot(direction, answer));
    for (std::size_t i = 0; i < n; ++i) {
      multiplier[i] += step.cwiseProduct(direction[i]);
      residual[i] -= step.cwiseProduct(answer[i]);
    }
    precondition();
    const Vec3 before = energy;
    energy = dot(residual, preconditioned);
    const Vec3 turn = ratio(energy, before);
    for (std::size_t i = 0; i < n; ++i) direction[i] = preconditioned[i] + turn.cwiseProduct(direction[i]);
  }
  const std::vector<Vec3>& change = system.change(multiplier);
  const Index first_link = links.start[body.begin];
  for (Index i = body.begin; i < body.end; ++i) {
    Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      gradient_vector(fit.there[l]) += change[l - first_link] / fit.weight[i];
      gradient_vector(fit.back[reverse[l]]) = gradient_vector(fit.there[l]);
    }
  }
  result.corrected = complete.size();
  result.remainder = largest(residual) / start;
  return result;
}

}  // namespace

Consistency make_consistent(const Particles& particles, const Neighborhood& links,
                            std::span<const Index> complete, std::span<const QuadraticFit> fits,
                            std::span<const Index> reverse, MovingLeastSquares& fit) {
  Consistency all;
  while (!complete.empty()) {
    const Index body = particles.body[complete.front()];
    const auto own = std::equal_range(particles.body.begin(), particles.body.end(), body);
    const auto count =
        std::count_if(complete.begin(), complete.end(), [&](Index k) { return particles.body[k] == body; });
    const Consistency one =
        make_body_consistent(particles, links,
                             {static_cast<Index>(own.first - particles.body.begin()),
                              static_cast<Index>(own.second - particles.body.begin())},
                             complete.first(static_cast<std::size_t>(count)), fits, reverse, fit);
    all.corrected += one.corrected;
    all.iterations = std::max(all.iterations, one.iterations);
    all.remainder = std::max(all.remainder, one.remainder);
    complete = complete.subspan(static_cast<std::size_t>(count));
  }
  return all;
}

CompleteNeighborhoods complete_neighborhoods(const Particles& particles, std::span<const Body> bodies,
                                             const Neighborhood& links, const Surface& surface) {
  std::vector<char> complete(particles.size(), 0);
  CompleteNeighborhoods result;
  for (const Body& body : bodies) {
    if (body.triangles.size() == 0) continue;
    TriangleTree tree(surface.rest,
                      std::span(surface.triangles).subspan(body.triangles.begin, body.triangles.size()));
    parallel_for_each(body.particles.size(), [&](std::size_t local) {
      const std::size_t i = body.particles.begin + local;
      complete[i] = tree.closest(particles.rest[i], links.support[i]).triangle == Closest::none;
    });
    const auto first = complete.begin() + body.particles.begin, last = complete.begin() + body.particles.end;
    if (auto count = static_cast<std::size_t>(std::count(first, last, 1)); count > most_corrected) {
      result.left_out += count;
      std::fill(first, last, 0);
    }
  }
  for (std::size_t i = 0; i < complete.size(); ++i)
    if (complete[i]) result.particles.push_back(static_cast<Index>(i));
  return result;
}

}  // namespace deforma
