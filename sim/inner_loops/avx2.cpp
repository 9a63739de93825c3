#include "sim/inner_loops/table.hpp"

namespace deforma {

extern const InnerLoops loops_avx2;
const InnerLoops loops_avx2 = inner_loops;

}  // namespace deforma
