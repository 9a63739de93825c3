#pragma once

#include <filesystem>

namespace deforma {

/// Refuses PLY and OFF files that hold less than their header announces, and text STL files without an end. The
/// importer would fill the gap with what it read last, or wait for a header's end that never comes.
/// Files of other kinds pass unread.
/// @throws std::runtime_error naming the file, what was announced and what was found.
void check_complete(const std::filesystem::path& file);

}  // namespace deforma
