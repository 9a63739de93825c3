#include "pipeline/bandwidth.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "pipeline/stopwatch.hpp"
#include "sim/parallel.hpp"

namespace deforma {

namespace {

constexpr std::size_t block = 1 << 16, blocks = 1 << 8;  // of 8 bytes: 128 MiB an array

void triad(double* a, const double* b, const double* c, double s) {
  for (std::size_t k = 0; k < block; ++k) a[k] = b[k] + s * c[k];
}

}  // namespace

double measure_bandwidth(Turns::Clock clock, int runs) {
  std::vector<double> a(block * blocks, 0.0), b(block * blocks, 1.0), c(block * blocks, 2.0);
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) {
    Stopwatch wall;
    ThreadStopwatch own;
    parallel_for_each(
        blocks, [&](std::size_t k) { triad(&a[k * block], &b[k * block], &c[k * block], 0.5 * run); }, 1);
    least = std::min(least, clock == Turns::Clock::wall ? wall.lap() : own.lap());
  }
  return 3.0 * sizeof(double) * block * blocks / least;
}

}  // namespace deforma
