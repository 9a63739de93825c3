#include "sim/gather_loops.hpp"

namespace deforma {

extern const Gather gather_avx2_fma;
const Gather gather_avx2_fma = gather;

}  // namespace deforma
