#include "sim/effects/hourglass.hpp"

#include <fmt/core.h>

#include <cmath>
#include <stdexcept>

#include "sim/per_body.hpp"

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "stiffness",
     .unit = "-",
     .meaning =
         "zeta: share of Young's modulus that acts against unseen modes; by default 10, with the linear "
         "gradient 1",
     .fallback = Curve<double>(10.0),
     .allowed = Interval::positive(),
     .derived = true},
};

class Hourglass : public Effect {
 public:
  Hourglass(const State& state, std::span<const EffectTable> tables) : zeta_(state.bodies.size()) {
    for (const EffectTable& table : tables) {
      const Body& body = state.bodies[table.body];
      if (!(body.young.at(state.time) > 0.0))
        throw std::invalid_argument(fmt::format(
            "hourglass: body '{}' has no elastic table, whose Young's modulus it scales with", body.name));
      // The quadratic fit's residual does not see bending, so that it can, and must, be stiffer.
      const double usual = state.fit.quadratic() ? 10.0 : 1.0;
      zeta_.add(table.body, table.parameters.given("stiffness") ? table.parameters.number("stiffness")
                                                                : Curve<double>(usual));
    }
  }

  std::string_view name() const override { return "hourglass"; }
  unsigned needs() const override { return needs_strain | needs_pair_stiffness; }

  void stress(const State& state, const Block& block, std::span<const Mat3>, std::span<Mat3>,
              std::span<double> pair_stiffness) override {
    const Curve<double>* zeta = zeta_.of(block.body);
    if (!zeta) return;
    const double modulus = zeta->at(state.time) * state.bodies[block.body].young.at(state.time);
    for (std::size_t k = 0; k < block.size(); ++k)
      pair_stiffness[k] = per_particle(state, block.particles.begin + k, modulus);
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    const Neighborhood& links = state.links;
    for (const auto& [body, zeta] : zeta_) {
      Range particles = state.bodies[body].particles;
      double modulus = zeta.at(state.time) * state.bodies[body].young.at(state.time);
      for (Index i = particles.begin; i < particles.end; ++i) {
        Mat3 gradient = state.F[i] - state.fit.projector(i);
        double residual = 0.0;
        Range row = links.row(i);
        for (Index l = row.begin; l < row.end; ++l) {
          Index j = links.links[l].j;
          Mat3 used =
              state.fit.quadratic() ? Mat3(0.5 * (gradient + state.F[j] - state.fit.projector(j))) : gradient;
          Vec3 e = used * (state.particles.rest[j] - state.particles.rest[i]) -
                   (state.particles.displacement[j] - state.particles.displacement[i]);
          residual += links.links[l].weight * e.squaredNorm();
        }
        sum += 0.5 * per_particle(state, i, modulus) * residual;
      }
    }
    return sum;
  }

  void stiffness_key(const State& state, std::span<double> per_body) const override {
    for (const auto& [body, zeta] : zeta_) per_body[body] += std::log(zeta.at(state.time));
  }

  std::size_t bytes() const override { return zeta_.bytes(); }

 private:
  // s_i with c_ij = s_i W_ij.
  static double per_particle(const State& state, std::size_t i, double modulus) {
    const double trace = state.fit.trace[i];
    return trace > 0.0 ? modulus * state.particles.volume[i] / trace : 0.0;
  }

  PerBody<Curve<double>> zeta_;
};

}  // namespace

const EffectInfo& hourglass_effect() {
  static const EffectInfo info = {
      .name = "hourglass",
      .summary =
          "suppresses zero-energy (hourglass) modes; every elastic body has it unless `hourglass = false`",
      .several = false,
      .in_world = false,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Hourglass>(state, tables);
      }};
  return info;
}

}  // namespace deforma
