#include "sim/effects/volume.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "sim/material.hpp"
#include "sim/per_body.hpp"

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
  Volume(const State& state, std::span<const EffectTable> tables) : kept_(state.bodies.size()) {
    for (const EffectTable& table : tables)
      kept_.add(table.body, {state.bodies[table.body].particles, table.parameters.number("stiffness")});
  }

  std::string_view name() const override { return "volume"; }
  unsigned needs() const override { return needs_strain; }

  void stress(const State& state, const Block& block, std::span<const Mat3> F, std::span<Mat3> P,
              std::span<double>) override {
    const Kept* kept = kept_.of(block.body);
    if (!kept) return;
    const double kv = kept->stiffness.at(state.time);
    for (std::size_t k = 0; k < block.size(); ++k) {
      if (state.fit.rank[block.particles.begin + k] < 3) continue;  // a sheet or a rope encloses no volume
      const Mat3 C = cofactor(F[k]);
      P[k] += kv * (F[k].col(0).dot(C.col(0)) - 1.0) * C;
    }
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    for (const auto& [body, kept] : kept_)
      for (Index i = kept.particles.begin; i < kept.particles.end; ++i) {
        if (state.fit.rank[i] < 3) continue;
        double change = state.F[i].determinant() - 1.0;
        sum += 0.5 * kept.stiffness.at(state.time) * state.fit.weight[i] * change * change;
      }
    return sum;
  }

  void energy_density(const State& state, const Block& block, std::span<const Mat3> F,
                      std::span<double> density) const override {
    const Kept* kept = kept_.of(block.body);
    if (!kept) return;
    for (std::size_t k = 0; k < block.size(); ++k) {
      if (state.fit.rank[block.particles.begin + k] < 3) continue;
      const double change = F[k].determinant() - 1.0;
      density[k] += 0.5 * kept->stiffness.at(state.time) * change * change;
    }
  }

  void stiffness_key(const State& state, std::span<double> per_body) const override {
    for (const auto& [body, kept] : kept_) per_body[body] += std::log(kept.stiffness.at(state.time));
  }

  std::size_t bytes() const override { return kept_.bytes(); }

 private:
  struct Kept {
    Range particles;
    Curve<double> stiffness;
  };
  PerBody<Kept> kept_;
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
