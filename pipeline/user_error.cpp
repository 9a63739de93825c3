#include "pipeline/user_error.hpp"

#include <fmt/core.h>

#include "sim/parameters.hpp"

namespace deforma {

std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates) {
  std::string nearest = nearest_name(word, candidates);
  return nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest);
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  std::vector<std::string_view> views(candidates.begin(), candidates.end());
  return did_you_mean(word, views);
}

}  // namespace deforma
