#pragma once

// What the inner loops (sim/inner_loops.hpp) are written with. They are compiled once for each set of instructions, and
// nothing but C headers and plain structs may be included beside them: a shared inline function compiled with more
// instructions than the processor has could be the one that is linked.
#include "sim/inner_loops.hpp"

namespace deforma {
namespace {

using Four = double __attribute__((vector_size(32), aligned(32), may_alias));
using UnalignedFour = double __attribute__((vector_size(32), aligned(8), may_alias));

#define DEFORMA_INLINE inline __attribute__((always_inline))

DEFORMA_INLINE Four load(const double* from) { return *reinterpret_cast<const Four*>(from); }
DEFORMA_INLINE Four load_unaligned(const double* from) {
  return *reinterpret_cast<const UnalignedFour*>(from);
}
DEFORMA_INLINE Four all(double x) { return Four{x, x, x, x}; }
/// The same, once and for all: the compiler would take what is subtracted from it before it is spread, one by one.
DEFORMA_INLINE Four all_kept(double x) {
  Four spread = all(x);
  asm("" : "+m"(spread));
  return spread;
}
DEFORMA_INLINE void store(double* to, Four x) { *reinterpret_cast<UnalignedFour*>(to) = x; }

DEFORMA_INLINE Four load_three(const double* from) { return Four{from[0], from[1], from[2], 0.0}; }
DEFORMA_INLINE void store_three(double* to, Four x) {
  to[0] = x[0];
  to[1] = x[1];
  to[2] = x[2];
}

/// Turns four rows into four columns.
DEFORMA_INLINE void transpose(Four& a, Four& b, Four& c, Four& d) {
  const Four ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6),
             ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7),
             cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6),
             cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}
DEFORMA_INLINE double total(Four x) { return (x[0] + x[1]) + (x[2] + x[3]); }

constexpr std::size_t next_block = 128;  // where what is written will be written next
DEFORMA_INLINE void ask_to_write(const double* to) { __builtin_prefetch(to, 1); }

}  // namespace
}  // namespace deforma
