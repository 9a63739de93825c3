#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace deforma {

/// What the solver has done so far.
struct SolverStatistics {
  std::uint64_t substeps = 0;
  double smallest_step = 0.0;  ///< [s]
  double largest_step = 0.0;   ///< [s]
  struct Pass {
    std::string name;  ///< a stage of the solver, or an effect
    std::uint64_t calls = 0;
    double seconds = 0.0;
    std::size_t bytes = 0;  ///< memory held
  };
  std::vector<Pass> effects;  ///< in running order
  std::vector<Pass> stages;   ///< deformation gradient, surface, force gather, integration, step measurement

  /// Memory held by all of them.
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto* passes : {&stages, &effects})
      for (const Pass& pass : *passes) sum += pass.bytes;
    return sum;
  }
};

/// Adds to a pass one call and the time from its making to its end.
class PassTimer {
 public:
  explicit PassTimer(SolverStatistics::Pass& pass) : pass_(pass), start_(std::chrono::steady_clock::now()) {}
  ~PassTimer() {
    pass_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    pass_.calls += counted_;
  }
  void discount() { counted_ = 0; }  ///< what was timed did nothing
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

 private:
  SolverStatistics::Pass& pass_;
  std::uint64_t counted_ = 1;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace deforma
