#include "sim/neighborhood.hpp"
#include "sim/skin.hpp"
#include "sim/state.hpp"
#include "tests/bench/bodies.hpp"

// What is done once for a scene, on all threads.
namespace deforma {

namespace {

void count_particles(benchmark::State& iterations, std::size_t particles) {
  iterations.counters["particles"] = benchmark::Counter(
      static_cast<double>(particles * iterations.iterations()), benchmark::Counter::kIsRate);
}

/// All of it: mesh, sampling, links, fit, skin and effects.
void measure_build(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  const Scene scene = bodies.scene(kind, particles);
  for (auto _ : iterations) {
    World world = build(scene);
    benchmark::DoNotOptimize(world.solver.get());
  }
  count_particles(iterations, static_cast<std::size_t>(particles));
}

void measure_links(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  const auto& made = bodies.get(kind, particles);
  const SolverSpec& spec = made.scene.solver;
  const NeighborhoodSettings settings = {.neighbors = spec.neighbors.value_or(30),
                                         .support = spec.support.value_or(1.7)};
  for (auto _ : iterations)
    benchmark::DoNotOptimize(build_neighborhood(made.state().particles, made.state().bodies, settings));
  count_particles(iterations, made.state().size());
}

void measure_fit(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  State state = bodies.get(kind, particles).state();
  const Gradient gradient = kind == BenchKind::quadratic ? Gradient::quadratic : Gradient::linear;
  for (auto _ : iterations) refit(state, gradient);
  count_particles(iterations, state.size());
}

void measure_skin(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  const State& state = bodies.get(kind, particles).state();
  for (auto _ : iterations)
    benchmark::DoNotOptimize(bind_skin(state.particles, state.bodies, state.links, state.surface.rest));
  iterations.counters["vertices"] = benchmark::Counter(
      static_cast<double>(state.surface.size() * iterations.iterations()), benchmark::Counter::kIsRate);
}

}  // namespace

void add_build_cases(BenchBodies& bodies, BenchKind kind, int particles) {
  auto add = [&](const std::string& stage, auto measure) {
    benchmark::RegisterBenchmark(
        case_name(stage, kind, particles).c_str(),
        [=, &bodies](benchmark::State& iterations) { measure(iterations, bodies, kind, particles); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  };
  add("build", measure_build);
  add("build_links", measure_links);
  add("build_fit", measure_fit);
  add("build_skin", measure_skin);
}

}  // namespace deforma
