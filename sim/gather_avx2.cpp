#include "sim/gather_loops.hpp"

namespace deforma {

extern const Gather gather_avx2;
const Gather gather_avx2 = gather;

}  // namespace deforma
