#include "sim/gather_loops.hpp"

namespace deforma {

extern const Gather gather_baseline;
const Gather gather_baseline = gather;

}  // namespace deforma
