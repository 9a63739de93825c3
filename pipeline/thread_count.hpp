#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace deforma {

/// Calls `body` with so many threads for its parallel loops, and returns what it returns.
/// @param count 0: as many as the machine has
template <typename Body>
auto on_threads(int count, const Body& body) {
  if (count <= 0) return body();
  // The limit holds for what other threads do meanwhile, too; but only an arena has more threads than the machine.
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
  return tbb::task_arena(count).execute(body);
}

}  // namespace deforma
