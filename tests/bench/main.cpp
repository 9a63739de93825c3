#include <fmt/core.h>

#include <exception>

#include "tests/bench/bodies.hpp"

using namespace deforma;

// Every stage at every size; --benchmark_filter chooses. Cases of one body follow each other, so that it is built once.
int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    BenchBodies bodies;
    for (int particles : bench_sizes) {
      for (BenchKind kind : {BenchKind::linear, BenchKind::quadratic}) {
        add_build_cases(bodies, kind, particles);
        add_step_cases(bodies, kind, particles);
        add_surface_cases(bodies, kind, particles);
      }
      add_step_cases(bodies, BenchKind::pair, particles);
    }
    add_frame_cases();
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
  benchmark::Shutdown();
  return 0;
}
