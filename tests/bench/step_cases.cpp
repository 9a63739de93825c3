#include <tbb/global_control.h>

#include <map>
#include <string>

#include "pipeline/bench.hpp"
#include "pipeline/reference_loop.hpp"
#include "tests/bench/bodies.hpp"

// Steps and their stages, on one thread and in its processor time.
namespace deforma {

namespace {

struct Alone {
  tbb::global_control control{tbb::global_control::max_allowed_parallelism, 1};
};

/// What every stage and effect has taken so far, by the solver's own clocks [s].
std::map<std::string, double> seconds_by_pass(const Solver& solver) {
  std::map<std::string, double> seconds;
  const SolverStatistics& statistics = solver.statistics();
  for (const auto* passes : {&statistics.stages, &statistics.effects})
    for (const SolverStatistics::Pass& pass : *passes) seconds[pass.name] += pass.seconds;
  return seconds;
}

/// Whole steps, and of every stage and effect that takes part the nanoseconds per particle.
void measure_step(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  Alone alone;
  Solver& solver = bodies.get(kind, particles).solver();
  advance_steps(solver, 2);  // measures the stable step
  const std::map<std::string, double> before = seconds_by_pass(solver);
  for (auto _ : iterations) advance_steps(solver, 1);
  const double particle_steps =
      static_cast<double>(solver.state().size()) * static_cast<double>(iterations.iterations());
  for (const auto& [pass, seconds] : seconds_by_pass(solver))
    if (const double spent = seconds - before.at(pass); spent > 0.0)
      iterations.counters["ns:" + pass] = 1e9 * spent / particle_steps;
  count(iterations, solver.state(), static_cast<double>(bytes_per_step(solver)), bodies.bandwidth());
}

/// Deformation gradients, stress and internal force, without the integration.
void measure_force(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  Alone alone;
  Solver& solver = bodies.get(kind, particles).solver();
  std::vector<Vec3> displacement = solver.state().particles.displacement, force(displacement.size());
  for (auto _ : iterations) {
    solver.static_force(displacement, force);
    benchmark::DoNotOptimize(force.data());
  }
  iterations.counters["particle-steps"] = benchmark::Counter(
      static_cast<double>(force.size() * iterations.iterations()), benchmark::Counter::kIsRate);
}

template <ReferenceLoop::Code code>
void measure_reference(benchmark::State& iterations, BenchBodies& bodies, BenchKind kind, int particles) {
  Solver& solver = bodies.get(kind, particles).solver();
  ReferenceLoop reference(solver.state(),
                          {bench_young, bench_poisson, kind == BenchKind::quadratic ? 10.0 : 1.0});
  const double dt = solver.stable_step();
  for (auto _ : iterations) reference.advance(1, dt, code);
  count(iterations, solver.state(), static_cast<double>(reference.bytes_per_step()), bodies.bandwidth());
}

}  // namespace

void add_step_cases(BenchBodies& bodies, BenchKind kind, int particles) {
  auto add = [&](const std::string& stage, auto measure) {
    benchmark::RegisterBenchmark(
        case_name(stage, kind, particles).c_str(),
        [=, &bodies](benchmark::State& iterations) { measure(iterations, bodies, kind, particles); })
        ->Unit(benchmark::kMicrosecond);
  };
  add("step", measure_step);
  if (kind != BenchKind::pair) {
    add("static_force", measure_force);
    add("plain_loop", measure_reference<ReferenceLoop::Code::best>);
    add("eigen_loop", measure_reference<ReferenceLoop::Code::eigen>);
  }
}

}  // namespace deforma
