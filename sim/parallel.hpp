#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace deforma {

/// Up to how many grains one thread takes alone. None where races are looked for: small bodies are to show them, too.
#ifdef DEFORMA_PLAIN_THREADS
inline constexpr std::size_t grains_alone = 0;
#else
inline constexpr std::size_t grains_alone = 2;
#endif

/// Calls `body(i)` for every i in [0, count), on several threads when the count pays for it.
///
/// Each call must write only what belongs to i: then the result is the same on any number of threads.
template <typename Body>
void parallel_for_each(std::size_t count, const Body& body, std::size_t grain = 512) {
  if (count <= grains_alone * grain) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& block) {
        for (std::size_t i = block.begin(); i != block.end(); ++i) body(i);
      },
      tbb::simple_partitioner());
}

}  // namespace deforma
