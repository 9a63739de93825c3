#pragma once

#include "pipeline/turns.hpp"

namespace deforma {

/// What the memory moves, in bytes per second: the best of several runs of a = b + s c over three arrays far larger than
/// any cache, on as many threads as TBB may use, counting 24 bytes for each element.
/// Source: the triad of McCalpin's STREAM.
///
/// @param clock the calling thread's only when that is the only thread
double measure_bandwidth(Turns::Clock clock, int runs = 7);

}  // namespace deforma
