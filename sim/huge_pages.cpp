#include "sim/huge_pages.hpp"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace deforma {

void use_huge_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
  constexpr std::uintptr_t page = std::uintptr_t{1} << 21;
#ifdef MADV_COLLAPSE
  constexpr int collapse = MADV_COLLAPSE;
#else
  constexpr int collapse = 25;  // since Linux 6.1; older ones refuse it, and move the pages in their own time
#endif
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page, last = (address + bytes) / page * page;
  if (first >= last) return;
  void* const whole = reinterpret_cast<void*>(first);
  // Refused where the system has none: then the pages stay as they are.
  if (madvise(whole, last - first, MADV_HUGEPAGE) == 0) madvise(whole, last - first, collapse);
#endif
}

}  // namespace deforma
