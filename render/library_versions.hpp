#pragma once

#include <string>
#include <utility>
#include <vector>

namespace deforma {

/// Name and version of the libraries for pictures and video that this process has loaded.
std::vector<std::pair<std::string, std::string>> render_library_versions();

}  // namespace deforma
