#pragma once

#include <cstddef>
#include <vector>

namespace deforma {

/// Asks the system to keep memory in pages of 2 MiB where it can: what is read in leaps over many megabytes finds its
/// small pages' addresses missing from the processor's table of them. Changes no content; does nothing elsewhere than
/// on Linux, or for what is smaller than such a page.
void use_huge_pages(void* begin, std::size_t bytes);

template <typename T>
void use_huge_pages(std::vector<T>& array) {
  use_huge_pages(array.data(), array.size() * sizeof(T));
}

}  // namespace deforma
