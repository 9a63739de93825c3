#include "sim/inner_loops/table.hpp"

namespace deforma {

extern const InnerLoops loops_baseline;
const InnerLoops loops_baseline = inner_loops;

}  // namespace deforma
