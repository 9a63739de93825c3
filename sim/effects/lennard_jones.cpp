#include "sim/effects/lennard_jones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/near_pairs.hpp"
#include "sim/parallel.hpp"

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "depth",
     .unit = "J",
     .meaning = "beta: depth of the potential's well, per pair of particles",
     .fallback = Curve<double>(0.0),
     .required = true,
     .allowed = Interval::non_negative()},
    {.key = "radius",
     .unit = "m",
     .meaning = "alpha: distance at which a pair neither gains nor loses, 0: the body's spacing",
     .fallback = Curve<double>(0.0),
     .allowed = Interval::non_negative(),
     .keyframed = false},
    {.key = "self", .unit = "-", .meaning = "acts within the body too", .fallback = false},
};

// Lengths in alpha.
constexpr double margin = 0.5;       // how far the search looks beyond the cut
constexpr double step_near = 0.04;   // how much a pair's distance may change in a step while some are near,
constexpr double look_ahead = 0.08;  // and in the two steps for which a measured stiffness has to serve
constexpr double step_far = 0.25;    // while none are

constexpr double resolved = 0.15;  // of the stable step, for a collision to keep its energy

double plain(double r) {
  const double s = 1.0 / (r * r * r * r * r * r);
  return 4.0 * (s * s - s);
}
double plain_slope(double r) {
  const double s = 1.0 / (r * r * r * r * r * r);
  return 4.0 * (6.0 * s - 12.0 * s * s) / r;
}
double plain_curvature(double r) {
  const double s = 1.0 / (r * r * r * r * r * r);
  return 4.0 * (156.0 * s * s - 42.0 * s) / (r * r);
}

class LennardJones : public Effect {
 public:
  LennardJones(const State& state, std::span<const EffectTable> tables) : kind_of_(state.bodies.size(), 0) {
    for (const EffectTable& table : tables) {
      const Parameters& p = table.parameters;
      const Body& body = state.bodies[table.body];
      const double radius = p.number("radius").at(0.0);
      kind_of_[table.body] = kinds_.size();
      kinds_.push_back({p.number("depth"), radius > 0.0 ? radius : body.spacing, p.flag("self"), 0.0});
      for (Index i = body.particles.begin; i < body.particles.end; ++i) members_.push_back(i);
    }
    std::sort(members_.begin(), members_.end());
    for (const Kind& kind : kinds_) {
      widest_ = std::max(widest_, kind.radius);
      narrowest_ = std::min(narrowest_, kind.radius);
    }
    pairs_ = NearPairs(LennardJonesPotential::cut * widest_, margin * widest_);
  }

  std::string_view name() const override { return "lennard_jones"; }

  bool near(const State& state) override {
    for (Kind& kind : kinds_) kind.depth_now = kind.depth.at(state.time);
    pairs_.update(state.particles, members_,
                  [&](Index i, Index j) { return act_on_each_other(state.particles, i, j); });
    stiffness_ = stiffness(state);
    return false;
  }

  void force(const State& state, std::span<Vec3> force) override {
    parallel_for_each(members_.size(), [&](std::size_t k) {
      const Index i = members_[k];
      const Vec3 x = state.particles.position(i);
      for (Index j : pairs_.of(i)) {
        const Pair pair = pair_of(state.particles, i, j);
        const Vec3 apart = x - state.particles.position(j);
        const double r = apart.stableNorm();
        if (r >= LennardJonesPotential::cut * pair.radius) continue;
        const Vec3 direction = r > 0.0 ? Vec3(apart / r) : Vec3(Vec3::UnitX() * (i < j ? 1.0 : -1.0));
        force[i] -=
            pair.depth / pair.radius * LennardJonesPotential::slope(r / pair.radius) * direction;  // eq 20
      }
    });
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    for (Index i : members_)
      for (Index j : pairs_.of(i)) {
        if (j < i) continue;
        const Pair pair = pair_of(state.particles, i, j);
        const double r = (state.particles.position(i) - state.particles.position(j)).stableNorm();
        sum += pair.depth * LennardJonesPotential::energy(r / pair.radius);
      }
    return sum;
  }

  double stable_step(const State& state) const override {
    Vec3 mean = Vec3::Zero();
    for (Index i : members_) mean += state.particles.velocity[i];
    mean /= static_cast<double>(members_.size());
    double fastest = 0.0;
    for (Index i : members_) fastest = std::max(fastest, (state.particles.velocity[i] - mean).squaredNorm());
    const double change = (pairs_.empty() ? step_far : step_near) * narrowest_;
    const double travel =
        fastest > 0.0 ? change / (2.0 * std::sqrt(fastest)) : std::numeric_limits<double>::infinity();
    return stiffness_ > 0.0 ? std::min(travel, resolved * 2.0 / std::sqrt(stiffness_)) : travel;
  }

  bool driven(double from, double to) const override {
    return std::any_of(kinds_.begin(), kinds_.end(),
                       [&](const Kind& kind) { return kind.depth.varies(from, to); });
  }

  std::size_t bytes() const override {
    return pairs_.bytes() + members_.capacity() * sizeof(Index) + kinds_.capacity() * sizeof(Kind);
  }

 private:
  struct Kind {
    Curve<double> depth;
    double radius;
    bool self;
    double depth_now;
  };
  struct Pair {
    double depth, radius;
  };

  Pair pair_of(const Particles& particles, Index i, Index j) const {
    const Kind &a = kinds_[kind_of_[particles.body[i]]], &b = kinds_[kind_of_[particles.body[j]]];
    return {0.5 * (a.depth_now + b.depth_now), 0.5 * (a.radius + b.radius)};
  }

  bool act_on_each_other(const Particles& particles, Index i, Index j) const {
    if (particles.body[i] != particles.body[j]) return true;
    const Kind& kind = kinds_[kind_of_[particles.body[i]]];
    // A lattice has many pairs exactly at the cut: they are left out too, or rounding would decide.
    const double cut = (1.0 + 1e-6) * LennardJonesPotential::cut * kind.radius;
    return kind.self && (particles.rest[i] - particles.rest[j]).norm() > cut;
  }

  // An upper bound of the squared frequencies [1/s^2] while distances change by no more than the look ahead.
  double stiffness(const State& state) const {
    double largest = 0.0;
    for (Index i : members_) {
      double sum = 0.0;
      for (Index j : pairs_.of(i)) {
        const Pair pair = pair_of(state.particles, i, j);
        const double r = (state.particles.position(i) - state.particles.position(j)).norm() / pair.radius;
        if (r > LennardJonesPotential::cut) continue;
        sum += pair.depth / (pair.radius * pair.radius) *
               std::max(0.0, LennardJonesPotential::curvature(r - look_ahead));
      }
      largest = std::max(largest, 2.0 * sum / state.particles.mass[i]);
    }
    return largest;
  }

  std::vector<Kind> kinds_;
  std::vector<std::size_t> kind_of_;  // of each body that has a table
  std::vector<Index> members_;        // ascending
  double widest_ = 0.0, narrowest_ = std::numeric_limits<double>::infinity();
  NearPairs pairs_{1.0, 1.0};
  double stiffness_ = 0.0;
};

}  // namespace

double LennardJonesPotential::energy(double r) {
  if (r >= cut) return 0.0;
  return (r < cap ? plain(cap) + plain_slope(cap) * (r - cap) : plain(r)) - plain(cut);
}

double LennardJonesPotential::slope(double r) { return r >= cut ? 0.0 : plain_slope(std::max(r, cap)); }

double LennardJonesPotential::curvature(double r) {
  return r >= cut ? 0.0 : plain_curvature(std::max(r, cap));
}

const EffectInfo& lennard_jones_effect() {
  static const EffectInfo info = {
      .name = "lennard_jones",
      .summary = "lets particles of different bodies repel when close and attract when near",
      .several = false,
      .in_world = false,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<LennardJones>(state, tables);
      }};
  return info;
}

}  // namespace deforma
