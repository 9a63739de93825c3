#pragma once

#include <benchmark/benchmark.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/bench_body.hpp"
#include "pipeline/build.hpp"

namespace deforma {

/// What is measured: one body by either fit, or two that touch and attract each other.
enum class BenchKind { linear, quadratic, pair };

std::string name_of(BenchKind kind);

/// Bodies to measure and the memory's bandwidth to compare with, made when first asked for. The body is kept until
/// another is asked for: cases of one size and kind should follow each other.
class BenchBodies {
 public:
  struct Made {
    Scene scene;
    World world;

    Solver& solver() const { return *world.solver; }
    const State& state() const { return world.solver->state(); }
  };

  Scene scene(BenchKind kind, int particles) const;
  Made& get(BenchKind kind, int particles);

  /// Of one thread [bytes/s].
  double bandwidth();

 private:
  BenchKind kind_ = BenchKind::linear;
  int particles_ = 0;
  std::unique_ptr<Made> made_;
  std::optional<double> bandwidth_;
};

/// The sizes that every case is measured at.
inline const std::vector<int> bench_sizes = {1000, 10000, 100000, 1000000};

/// A case's name: stage/kind/particles.
std::string case_name(const std::string& stage, BenchKind kind, int particles);

/// Counters of an iteration that handled every particle and link once and moved so many bytes.
void count(benchmark::State& iterations, const State& state, double bytes, double bandwidth);

// The cases by what they measure; `bodies` must outlive them.
void add_step_cases(BenchBodies& bodies, BenchKind kind, int particles);
void add_build_cases(BenchBodies& bodies, BenchKind kind, int particles);
void add_surface_cases(BenchBodies& bodies, BenchKind kind, int particles);
void add_frame_cases();

}  // namespace deforma
