#include "sim/effects/load.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "force", .unit = "N", .meaning = "in total", .fallback = Curve<Vec3>(Vec3(0, 0, 0))},
    {.key = "traction", .unit = "Pa", .meaning = "per area at rest", .fallback = Curve<Vec3>(Vec3(0, 0, 0))},
    {.key = "region", .unit = "m", .meaning = "where the surface is loaded, at rest", .fallback = Region{}},
};

class Load : public Effect {
 public:
  Load(const State& state, std::span<const EffectTable> tables) {
    for (const EffectTable& table : tables) {
      const Parameters& p = table.parameters;
      const Body& body = state.bodies[table.body];
      if (!p.given("force") && !p.given("traction"))
        throw std::invalid_argument(
            fmt::format("a load on body '{}' needs a force [N] or a traction [Pa]", body.name));
      Patch patch{p.vector("force"), p.vector("traction"), {}, 0.0};
      for (Index s = body.vertices.begin; s < body.vertices.end; ++s) {
        if (!p.region("region").contains(state.surface.rest[s])) continue;
        patch.vertices.push_back(s);
        patch.area += state.surface.area[s];
      }
      if (!(patch.area > 0.0))
        throw std::invalid_argument(
            fmt::format("the region of a load on body '{}' holds none of its {} surface vertices", body.name,
                        body.vertices.size()));
      patches_.push_back(std::move(patch));
    }
  }

  std::string_view name() const override { return "load"; }
  unsigned needs() const override { return needs_surface; }

  bool near(const State&) override { return std::exchange(unmarked_, false); }

  void mark(const State&, std::span<std::uint8_t> wanted) const override {
    for (const Patch& patch : patches_)
      for (Index s : patch.vertices) wanted[s] = 1;
  }

  void surface_force(const State& state, std::span<Vec3> force) override {
    for (const Patch& patch : patches_) {
      const Vec3 per_area = patch.per_area(state.time);
      for (Index s : patch.vertices) force[s] += state.surface.area[s] * per_area;
    }
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    for (const Patch& patch : patches_) {
      const Vec3 per_area = patch.per_area(state.time);
      for (Index s : patch.vertices)
        sum -= state.surface.area[s] * per_area.dot(state.surface.position[s] - state.surface.rest[s]);
    }
    return sum;
  }

  bool driven(double from, double to) const override {
    return std::any_of(patches_.begin(), patches_.end(), [&](const Patch& patch) {
      return patch.force.varies(from, to) || patch.traction.varies(from, to);
    });
  }

  std::size_t bytes() const override {
    std::size_t sum = 0;
    for (const Patch& patch : patches_) sum += sizeof(Patch) + patch.vertices.capacity() * sizeof(Index);
    return sum;
  }

 private:
  struct Patch {
    Curve<Vec3> force, traction;
    std::vector<Index> vertices;
    double area;  // of them all [m^2]

    Vec3 per_area(double time) const { return force.at(time) / area + traction.at(time); }
  };

  std::vector<Patch> patches_;
  bool unmarked_ = true;
};

}  // namespace

const EffectInfo& load_effect() {
  static const EffectInfo info = {
      .name = "load",
      .summary = "pulls or pushes on a part of the surface with a given force",
      .several = true,
      .in_world = false,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Load>(state, tables);
      }};
  return info;
}

}  // namespace deforma
