#include "sim/effects/pin.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "sim/rotation.hpp"

namespace deforma {

namespace {

constexpr double degree = std::numbers::pi / 180.0;

const Setting settings[] = {
    {.key = "region", .unit = "m", .meaning = "which particles, at rest", .fallback = Region{}},
    {.key = "move", .unit = "m", .meaning = "displacement", .fallback = Curve<Vec3>(Vec3(0, 0, 0))},
    {.key = "rotation",
     .unit = "degrees",
     .meaning = "rotation vector: axis times angle",
     .fallback = Curve<Vec3>(Vec3(0, 0, 0))},
    {.key = "center",
     .unit = "m",
     .meaning = "of the rotation, at rest; by default the middle of the pinned particles",
     .fallback = Curve<Vec3>(Vec3(0, 0, 0)),
     .keyframed = false,
     .derived = true},
    {.key = "release",
     .unit = "s",
     .meaning = "when to let go; by default never",
     .fallback = Curve<double>(std::numeric_limits<double>::infinity()),
     .allowed = Interval::non_negative(),
     .keyframed = false},
};

struct Grip {
  std::vector<Index> particles;
  Curve<Vec3> move, rotation;
  Vec3 center;
  double release;
  bool holds = true;

  void place(State& state) const {
    const double time = state.time;
    const Vec3 vector = degree * rotation.at(time), rate = degree * rotation.rate(time);
    const Mat3 turn = rotation_matrix(vector);
    const Vec3 spin = angular_velocity(vector, rate), shift = move.at(time), drift = move.rate(time);
    for (Index i : particles) {
      const Vec3 arm = state.particles.rest[i] - center;
      const Vec3 turned = turn * arm;
      state.particles.displacement[i] = turned - arm + shift;
      state.particles.velocity[i] = spin.cross(turned) + drift;
    }
  }
};

class Pin : public Effect {
 public:
  Pin(const State& state, std::span<const EffectTable> tables) {
    for (const EffectTable& table : tables) {
      const Parameters& p = table.parameters;
      const Body& body = state.bodies[table.body];
      Grip grip{{}, p.vector("move"), p.vector("rotation"), Vec3::Zero(), p.number("release").at(0.0)};
      for (Index i = body.particles.begin; i < body.particles.end; ++i) {
        if (!p.region("region").contains(state.particles.rest[i])) continue;
        grip.particles.push_back(i);
        grip.center += state.particles.rest[i];
      }
      if (grip.particles.empty())
        throw std::invalid_argument(
            fmt::format("the region of a pin on body '{}' holds none of its {} particles", body.name,
                        body.particles.size()));
      grip.center = p.given("center") ? p.vector("center").at(0.0)
                                      : Vec3(grip.center / static_cast<double>(grip.particles.size()));
      grips_.push_back(std::move(grip));
    }
  }

  std::string_view name() const override { return "pin"; }

  void prescribe(State& state) override {
    for (Grip& grip : grips_) {
      if (!grip.holds || state.time < grip.release) continue;
      grip.holds = false;
      for (Index i : grip.particles) state.fixed[i] = 0;
    }
    for (const Grip& grip : grips_) {  // where two hold one particle the later prevails
      if (!grip.holds) continue;
      for (Index i : grip.particles) state.fixed[i] = 1;
      grip.place(state);
    }
  }

  // What is let go takes part in the stiffness again.
  void stiffness_key(const State& state, std::span<double> per_body) const override {
    for (const Grip& grip : grips_)
      per_body[state.particles.body[grip.particles.front()]] += grip.holds ? 1.0 : 0.0;
  }

  // What is moved to and fro in between stands where it stood.
  bool driven(double from, double to) const override {
    return std::any_of(grips_.begin(), grips_.end(), [&](const Grip& grip) {
      return from < grip.release && (grip.move.varies(from, to) || grip.rotation.varies(from, to));
    });
  }

  std::size_t bytes() const override {
    std::size_t sum = 0;
    for (const Grip& grip : grips_) sum += sizeof(Grip) + grip.particles.capacity() * sizeof(Index);
    return sum;
  }

 private:
  std::vector<Grip> grips_;
};

}  // namespace

const EffectInfo& pin_effect() {
  static const EffectInfo info = {
      .name = "pin",
      .summary = "holds particles, or moves them along keyframes",
      .several = true,
      .in_world = false,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Pin>(state, tables);
      }};
  return info;
}

}  // namespace deforma
