#include <fmt/core.h>
#include <tbb/global_control.h>

#include <memory>

#include "pipeline/bench.hpp"
#include "sim/effects/elastic.hpp"
#include "sim/effects/hourglass.hpp"

namespace deforma {

namespace {

/// A scene, and the same with something more.
struct Addition {
  std::string effect, what;
  std::unique_ptr<Solver> without, with;
};

Scene one_body(const BenchSettings& settings) {
  BenchBody body = bench_box(settings.quick ? 1000 : 8000);
  body.links = bench_links;
  return bench_scene(body);
}

std::unique_ptr<Solver> solver_of(const Scene& scene) { return build(scene).solver; }

/// The same solver with its effects made one by one, as if there were no others to call for.
std::unique_ptr<Solver> without_registry(const Scene& scene) {
  State state = build(scene).solver->state();
  std::vector<std::unique_ptr<Effect>> effects;
  for (const SceneEffect& effect : scene.bodies[0].effects) {
    const EffectTable table{0, effect.parameters};
    const EffectInfo& info = effect.info->name == "elastic" ? elastic_effect() : hourglass_effect();
    effects.push_back(info.make(state, std::span(&table, 1)));
  }
  return std::make_unique<Solver>(std::move(state), std::move(effects), SolverSettings());
}

using Values = std::vector<std::pair<std::string_view, SettingValue>>;

Addition added(const Scene& base, const std::string& effect, const std::string& what, const Values& values) {
  Scene scene = base;
  for (SceneBody& body : scene.bodies) add_effect(body, effect, values);
  return {effect, what, solver_of(base), solver_of(scene)};
}

Addition on_the_ground(const BenchSettings& settings, double height) {
  Scene base = one_body(settings);
  base.bodies[0].angular_velocity.setZero();
  base.bodies[0].position.z() += height * bench_spacing;
  add_effect(base.bodies[0], "gravity");
  Scene scene = base;
  scene.ground.emplace();
  add_effect(scene.bodies[0], "contact");
  return {"contact", height < 1.0 ? "on the ground" : "nothing near", solver_of(base), solver_of(scene)};
}

std::vector<Addition> additions(const BenchSettings& settings) {
  const Scene base = one_body(settings);
  const SceneBody& body = base.bodies[0];
  Region top;
  top.min.z() = 2.0 * body.position.z() - 0.01 * bench_spacing;
  Scene elastic = base;
  elastic.bodies[0].effects.pop_back();
  const Curve<Vec3> force(Vec3(0, 0, 1));

  std::vector<Addition> all;
  all.push_back({"none", "made by hand / by the registry", without_registry(base), solver_of(base)});
  all.push_back({"hourglass", "", solver_of(elastic), solver_of(base)});
  all.push_back(added(base, "volume", "", {{"stiffness", Curve<double>(bench_young)}}));
  all.push_back(added(base, "gravity", "", {}));
  all.push_back(added(base, "damping", "rate", {{"rate", Curve<double>(0.01)}}));
  all.push_back(added(base, "damping", "viscosity", {{"viscosity", Curve<double>(10.0)}}));
  all.push_back(added(base, "pressure", "", {{"value", Curve<double>(100.0)}}));
  all.push_back(added(base, "load", "on one face", {{"force", force}, {"region", top}}));
  all.push_back(added(base, "pin", "of one face, with its particles", {{"region", top}}));
  all.push_back(on_the_ground(settings, 100.0));
  all.push_back(on_the_ground(settings, 0.05));
  BenchBody half = bench_box(settings.quick ? 512 : 4096);
  half.links = bench_links;
  const Scene near = bench_pair(half, 0.05);
  all.push_back(added(near, "contact", "of two bodies", {}));
  all.push_back(added(near, "lennard_jones", "of two bodies", {{"depth", Curve<double>(1e-4)}}));
  return all;
}

}  // namespace

BenchTable bench_effects(const BenchSettings& settings) {
  tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  settings.tell("effects");
  std::vector<Addition> all = additions(settings);
  BenchTable table = {
      "effects",
      fmt::format("What an effect adds to a step: {} particles in one body or two, linear fit, "
                  "elastic + hourglass, one thread",
                  all.front().with->state().size()),
      {{"effect", "effect", 0},
       {"what", "", 0},
       {"without_microseconds", "us without", 1},
       {"with_microseconds", "us with", 1},
       {"added_microseconds", "us added", 1},
       {"added_percent", "% added", 1}},
      {},
      {}};
  for (Addition& one : all) {
    settings.tell(fmt::format("effects: {} {}", one.effect, one.what));
    auto steps_of = [](Solver& solver) {
      return [&solver](double steps) { return advance_steps(solver, steps); };
    };
    const std::vector<std::function<double(double)>> things = {steps_of(*one.without), steps_of(*one.with)};
    const std::vector<double> seconds = take_turns(things, settings.turns);
    table.rows.push_back({one.effect, one.what, 1e6 * seconds[0], 1e6 * seconds[1],
                          1e6 * (seconds[1] - seconds[0]), 100.0 * (seconds[1] / seconds[0] - 1.0)});
  }
  return table;
}

}  // namespace deforma
