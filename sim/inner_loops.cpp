#include "sim/inner_loops.hpp"

#include <fmt/core.h>

#include <stdexcept>

namespace deforma {

extern const InnerLoops loops_baseline;
#ifdef DEFORMA_AVX2
extern const InnerLoops loops_avx2, loops_avx2_fma;
#endif

std::string_view instructions_name(Instructions instructions) {
  constexpr std::string_view names[] = {"baseline", "avx2", "avx2_fma"};
  return names[static_cast<int>(instructions)];
}

bool supports(Instructions instructions) {
  if (instructions == Instructions::baseline) return true;
#ifdef DEFORMA_AVX2
  return __builtin_cpu_supports("avx2") &&
         (instructions == Instructions::avx2 || __builtin_cpu_supports("fma"));
#else
  return false;
#endif
}

Instructions fastest_instructions() {
  return supports(Instructions::avx2_fma) ? Instructions::avx2_fma : portable_instructions();
}

Instructions portable_instructions() {
  return supports(Instructions::avx2) ? Instructions::avx2 : Instructions::baseline;
}

const InnerLoops& inner_loops_of(Instructions instructions) {
  if (!supports(instructions))
    throw std::invalid_argument(
        fmt::format("this processor does not have the instructions '{}'", instructions_name(instructions)));
#ifdef DEFORMA_AVX2
  if (instructions == Instructions::avx2) return loops_avx2;
  if (instructions == Instructions::avx2_fma) return loops_avx2_fma;
#endif
  return loops_baseline;
}

}  // namespace deforma
