#include "sim/effects/damping.hpp"

#include <algorithm>

#include "sim/per_body.hpp"

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "rate",
     .unit = "1/s",
     .meaning = "slows every motion, falling too",
     .fallback = Curve<double>(0.0),
     .allowed = Interval::non_negative()},
    {.key = "viscosity",
     .unit = "Pa s",
     .meaning = "resists the rate of deformation only: stress over rate of Green strain",
     .fallback = Curve<double>(0.0),
     .allowed = Interval::non_negative()},
};

struct Damped {
  Range particles;
  double spacing;
  Curve<double> rate, viscosity;

  bool viscous() const {
    return std::any_of(viscosity.keys().begin(), viscosity.keys().end(),
                       [](const auto& k) { return k.second > 0.0; });
  }
};

class Damping : public Effect {
 public:
  Damping(const State& state, std::span<const EffectTable> tables) : damped_(state.bodies.size()) {
    for (const EffectTable& table : tables) {
      const Body& body = state.bodies[table.body];
      const Parameters& p = table.parameters;
      const Damped& damped =
          damped_.add(table.body, {body.particles, body.spacing, p.number("rate"), p.number("viscosity")});
      viscous_ = viscous_ || damped.viscous();
    }
  }

  std::string_view name() const override { return "damping"; }
  unsigned needs() const override { return viscous_ ? needs_strain | needs_strain_rate : needs_nothing; }

  void stress(const State& state, const Block& block, std::span<const Mat3> F, std::span<Mat3> P,
              std::span<double>) override {
    const Damped* damped = damped_.of(block.body);
    const double eta = damped ? damped->viscosity.at(state.time) : 0.0;
    if (!(eta > 0.0)) return;
    for (std::size_t k = 0; k < block.size(); ++k) {
      const Mat3 half = F[k].transpose() * state.F_rate[block.particles.begin + k];
      P[k] += (0.5 * eta) * F[k] * (half + half.transpose());
    }
  }

  void finish(State& state, double dt) override {
    for (const auto& [index, body] : damped_) {
      double rate = body.rate.at(state.time);
      if (!(rate > 0.0)) continue;
      double kept = 1.0 / (1.0 + rate * dt);
      for (Index i = body.particles.begin; i < body.particles.end; ++i)
        if (!state.fixed[i]) state.particles.velocity[i] *= kept;
    }
  }

  // Viscosity is an explicit diffusion of velocity with diffusivity eta/rho, F F^T stretching it. On the
  // lattices and supports in use the largest eigenvalue of the discrete operator stays below 4 eta/(rho d^2).
  double stable_step(const State& state) const override {
    double step = std::numeric_limits<double>::infinity();
    for (const auto& [index, body] : damped_) {
      double eta = body.viscosity.at(state.time);
      if (!(eta > 0.0)) continue;
      double stretch = 1.0, density = std::numeric_limits<double>::infinity();
      for (Index i = body.particles.begin; i < body.particles.end; ++i) {
        stretch = std::max(stretch, state.F[i].squaredNorm() / 3.0);
        density = std::min(density, state.particles.mass[i] / state.particles.volume[i]);
      }
      step = std::min(step, 0.5 * density * body.spacing * body.spacing / (eta * stretch * stretch));
    }
    return step;
  }

  std::size_t bytes() const override { return damped_.bytes(); }

 private:
  PerBody<Damped> damped_;
  bool viscous_ = false;
};

}  // namespace

const EffectInfo& damping_effect() {
  static const EffectInfo info = {
      .name = "damping",
      .summary = "takes energy away: from all motion (rate) or from deformation alone (viscosity)",
      .several = false,
      .in_world = true,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Damping>(state, tables);
      }};
  return info;
}

}  // namespace deforma
