#include "sim/effects/gravity.hpp"

#include <algorithm>

#include "sim/parallel.hpp"

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "acceleration",
     .unit = "m/s^2",
     .meaning = "acceleration of free fall",
     .fallback = Curve<Vec3>(Vec3(0, 0, -9.81))},
};

class Gravity : public Effect {
 public:
  Gravity(const State& state, std::span<const EffectTable> tables) {
    for (const EffectTable& table : tables)
      pulled_.push_back({state.bodies[table.body].particles, table.parameters.vector("acceleration")});
  }

  std::string_view name() const override { return "gravity"; }

  void force(const State& state, std::span<Vec3> force) override {
    for (const Pulled& body : pulled_) {
      Vec3 g = body.acceleration.at(state.time);
      parallel_for_each(body.particles.size(), [&](std::size_t local) {
        std::size_t i = body.particles.begin + local;
        force[i] += state.particles.mass[i] * g;
      });
    }
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    for (const Pulled& body : pulled_) {
      Vec3 g = body.acceleration.at(state.time);
      for (Index i = body.particles.begin; i < body.particles.end; ++i)
        sum -= state.particles.mass[i] * g.dot(state.particles.displacement[i]);
    }
    return sum;
  }

  bool driven(double from, double to) const override {
    return std::any_of(pulled_.begin(), pulled_.end(),
                       [&](const Pulled& body) { return body.acceleration.varies(from, to); });
  }

  std::size_t bytes() const override { return pulled_.size() * sizeof(Pulled); }

 private:
  struct Pulled {
    Range particles;
    Curve<Vec3> acceleration;
  };
  std::vector<Pulled> pulled_;
};

}  // namespace

const EffectInfo& gravity_effect() {
  static const EffectInfo info = {
      .name = "gravity",
      .summary = "pulls every particle the same way",
      .several = false,
      .in_world = true,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Gravity>(state, tables);
      }};
  return info;
}

}  // namespace deforma
