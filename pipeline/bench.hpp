#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipeline/bench_body.hpp"
#include "pipeline/bench_table.hpp"
#include "pipeline/build.hpp"
#include "pipeline/turns.hpp"

// The measurements of `deforma bench`, one function for each of its tables. Nothing here judges: what a machine
// reaches depends on what else it does.
namespace deforma {

struct BenchSettings {
  std::vector<int> sizes;  ///< particles of the bodies of the table of steps
  int middle = 64000;      ///< particles where one size stands for all
  int threads = 1;         ///< that may be used
  double bandwidth = 0.0;  ///< of the memory on one thread [bytes/s]
  Turns turns;             ///< the clock is each table's own choice
  bool quick = false;
  std::function<void(const std::string&)> tell = [](const std::string&) {};  ///< what is being measured
};

/// Advances by about so many substeps, and tells how many.
double advance_steps(Solver& solver, double steps);

/// What one step reads and writes at the least [bytes]: links once for each gather, and a particle's own quantities once
/// for each loop that cannot keep them, if nothing but a block of particles stays in the cache.
std::size_t bytes_per_step(const Solver& solver);

/// Speed of whole steps on one thread by fit and size, beside the reference loop's; and what building took.
std::vector<BenchTable> bench_steps(const BenchSettings& settings);

/// Where the time of a step goes, on one thread.
BenchTable bench_stages(const BenchSettings& settings);

/// Whole steps on more and more threads.
BenchTable bench_threads(const BenchSettings& settings);

/// What each effect adds to a step when a scene calls for it, on one thread.
BenchTable bench_effects(const BenchSettings& settings);

/// The three objects of the paper's table 3.
BenchTable bench_paper(const BenchSettings& settings);

}  // namespace deforma
