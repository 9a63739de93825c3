#include "sim/effects/volume.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "sim/material.hpp"
#include "sim/parallel.hpp"

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "stiffness",
     .unit = "Pa",
     .meaning = "kv: added bulk stiffness",
     .fallback = Curve<double>(1e6),
     .required = true,
     .allowed = Interval::positive()},
};

class Volume : public Effect {
 public:
  Volume(const State& state, std::span<const EffectTable> tables) {
    for (const EffectTable& table : tables)
      kept_.push_back({state.bodies[table.body].particles, table.parameters.number("stiffness")});
  }

  std::string_view name() const override { return "volume"; }
  unsigned needs() const override { return needs_strain; }

  void stress(const State& state, std::span<const Mat3> F, std::span<Mat3> P, std::span<double>) override {
    for (const Kept& body : kept_) {
      double kv = body.stiffness.at(state.time);
      parallel_for_each(body.particles.size(), [&](std::size_t local) {
        std::size_t i = body.particles.begin + local;
        if (state.fit.rank[i] < 3) return;  // a sheet or a rope encloses no volume
        Mat3 C = cofactor(F[i]);
        P[i] += kv * (F[i].col(0).dot(C.col(0)) - 1.0) * C;
      });
    }
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    for (const Kept& body : kept_)
      for (Index i = body.particles.begin; i < body.particles.end; ++i) {
        if (state.fit.rank[i] < 3) continue;
        double change = state.F[i].determinant() - 1.0;
        sum += 0.5 * body.stiffness.at(state.time) * state.fit.weight[i] * change * change;
      }
    return sum;
  }

  void stiffness_key(const State& state, std::span<double> per_body) const override {
    for (const Kept& body : kept_)
      per_body[state.particles.body[body.particles.begin]] += std::log(body.stiffness.at(state.time));
  }

  std::size_t bytes() const override { return kept_.size() * sizeof(Kept); }

 private:
  struct Kept {
    Range particles;
    Curve<double> stiffness;
  };
  std::vector<Kept> kept_;
};

}  // namespace

const EffectInfo& volume_effect() {
  static const EffectInfo info = {
      .name = "volume",
      .summary = "resists change of volume beyond what the elastic material does",
      .several = false,
      .in_world = false,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Volume>(state, tables);
      }};
  return info;
}

}  // namespace deforma
