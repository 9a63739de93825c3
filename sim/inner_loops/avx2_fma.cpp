#include "sim/inner_loops/table.hpp"

namespace deforma {

extern const InnerLoops loops_avx2_fma;
const InnerLoops loops_avx2_fma = inner_loops;

}  // namespace deforma
