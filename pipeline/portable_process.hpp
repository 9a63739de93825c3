#pragma once

namespace deforma {

/// Makes sure that this process computes the same bits on any x86-64 processor as far as the C library is concerned:
/// glibc picks variants of exp, sin and their like by what the processor has, and those with fused operations round
/// otherwise. Starts the program anew, with the same arguments, unless that has been seen to already; so it is to be
/// called before anything has been written.
/// @throws std::runtime_error when the program cannot be started again.
void compute_portably();

}  // namespace deforma
