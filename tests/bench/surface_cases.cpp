#include "sim/skin.hpp"
#include "tests/bench/bodies.hpp"

// What is done for every frame before it is drawn, on all threads.
namespace deforma {

namespace {

void count_vertices(benchmark::State& iterations, std::size_t vertices) {
  iterations.counters["vertices"] = benchmark::Counter(
      static_cast<double>(vertices * iterations.iterations()), benchmark::Counter::kIsRate);
}

void measure_skinning(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  const Solver& solver = bodies.get(kind, particles).solver();
  std::vector<Vec3> points(solver.state().surface.size());
  for (auto _ : iterations) {
    solver.deform(points);
    benchmark::DoNotOptimize(points.data());
  }
  count_vertices(iterations, points.size());
}

void measure_normals(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  const Surface& surface = bodies.get(kind, particles).state().surface;
  std::vector<Vec3> normals(surface.size());
  for (auto _ : iterations) {
    vertex_normals(surface.rest, surface.triangles, normals);
    benchmark::DoNotOptimize(normals.data());
  }
  count_vertices(iterations, normals.size());
}

}  // namespace

void add_surface_cases(BenchBodies& bodies, BenchKind kind, int particles) {
  auto add = [&](const std::string& stage, auto measure) {
    benchmark::RegisterBenchmark(
        case_name(stage, kind, particles).c_str(),
        [=, &bodies](benchmark::State& iterations) { measure(iterations, bodies, kind, particles); })
        ->Unit(benchmark::kMicrosecond)
        ->UseRealTime();
  };
  add("skinning", measure_skinning);
  add("normals", measure_normals);
}

}  // namespace deforma
