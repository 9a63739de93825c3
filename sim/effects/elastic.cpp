#include "sim/effects/elastic.hpp"

#include <cmath>

#include "sim/material.hpp"
#include "sim/per_body.hpp"

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "young",
     .unit = "Pa",
     .meaning = "Young's modulus",
     .fallback = Curve<double>(1e5),
     .required = true,
     .allowed = Interval::positive()},
    {.key = "poisson",
     .unit = "-",
     .meaning = "Poisson's ratio",
     .fallback = Curve<double>(0.3),
     .allowed = Interval::open(-1.0, 0.5)},
    {.key = "material",
     .unit = "-",
     .meaning = "stress-strain law",
     .fallback = std::string("neo_hookean"),
     .choices = {material_names().begin(), material_names().end()}},
};

struct Solid {
  Range particles;
  Material material;
  Curve<double> young, poisson;
  Lame lame;  // now

  void update(double time) { lame = lame_constants(young.at(time), poisson.at(time)); }
};

class Elastic : public Effect {
 public:
  Elastic(State& state, std::span<const EffectTable> tables) : solids_(state.bodies.size()) {
    for (const EffectTable& table : tables) {
      const Parameters& p = table.parameters;
      Solid& solid = solids_.add(table.body, {state.bodies[table.body].particles,
                                              material_from_name(p.text("material")),
                                              p.number("young"),
                                              p.number("poisson"),
                                              {}});
      solid.update(state.time);
      state.bodies[table.body].young = p.number("young");
      state.bodies[table.body].modulus = solid.lame.p_wave_modulus();
    }
  }

  std::string_view name() const override { return "elastic"; }
  unsigned needs() const override { return needs_strain; }

  bool near(const State& state) override {
    for (auto& [body, solid] : solids_)
      if (solid.young.varies() || solid.poisson.varies()) solid.update(state.time);
    return false;
  }

  void stress(const State& state, const Block& block, std::span<const Mat3> F, std::span<Mat3> P,
              std::span<double>) override {
    const Solid* solid = solids_.of(block.body);
    if (!solid) return;
    const MovingLeastSquares& fit = state.fit;
    const std::size_t begin = block.particles.begin;
    for (std::size_t k = 0; k < block.size();) {
      if (fit.rank[begin + k] < 3) {
        P[k] +=
            reduced_first_piola_kirchhoff(solid->lame, F[k], fit.projector(begin + k), fit.rank[begin + k]);
        ++k;
        continue;
      }
      std::size_t end = k + 1;  // of those that span space, all at once
      while (end < block.size() && fit.rank[begin + end] == 3) ++end;
      add_first_piola_kirchhoff(solid->material, solid->lame, F.subspan(k, end - k), P.subspan(k, end - k),
                                state.links.loops());
      k = end;
    }
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    for (const auto& [body, solid] : solids_)
      for (Index i = solid.particles.begin; i < solid.particles.end; ++i)
        sum += state.fit.weight[i] * density_at(solid, state.fit, i, state.F[i]);
    return sum;
  }

  void energy_density(const State& state, const Block& block, std::span<const Mat3> F,
                      std::span<double> density) const override {
    const Solid* solid = solids_.of(block.body);
    if (!solid) return;
    for (std::size_t k = 0; k < block.size(); ++k)
      density[k] += density_at(*solid, state.fit, block.particles.begin + k, F[k]);
  }

  void stiffness_key(const State&, std::span<double> per_body) const override {
    for (const auto& [body, solid] : solids_) per_body[body] += std::log(solid.lame.p_wave_modulus());
  }

  std::size_t bytes() const override { return solids_.bytes(); }

 private:
  static double density_at(const Solid& solid, const MovingLeastSquares& fit, std::size_t i, const Mat3& F) {
    return fit.rank[i] == 3 ? deforma::energy_density(solid.material, solid.lame, F)
                            : reduced_energy_density(solid.lame, F, fit.projector(i), fit.rank[i]);
  }

  PerBody<Solid> solids_;
};

}  // namespace

const EffectInfo& elastic_effect() {
  static const EffectInfo info = {
      .name = "elastic",
      .summary = "resists deformation and returns to the rest shape",
      .several = false,
      .in_world = false,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Elastic>(state, tables);
      }};
  return info;
}

}  // namespace deforma
