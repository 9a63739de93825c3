#include "render/quality.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace deforma {
namespace {

constexpr std::array<std::string_view, 3> names = {"draft", "standard", "final"};

constexpr Detail draft = {.antialiasing = {1, 1},
                          .fits_machine = false,
                          .shadow_size = 512,
                          .ground_size = 160,
                          .sky_size = 48,
                          .body_taps = 4,
                          .blocker_taps = 8,
                          .ground_taps = 8,
                          .sky_taps = 10};
constexpr Detail final_detail = {.antialiasing = {4, 2},
                                 .fits_machine = false,
                                 .shadow_size = 2048,
                                 .ground_size = 640,
                                 .sky_size = 192,
                                 .body_taps = 24,
                                 .blocker_taps = 24,
                                 .ground_taps = 32,
                                 .sky_taps = 32};

}  // namespace

std::string name_of(const Antialiasing& antialiasing) {
  const std::string multi = fmt::format("{}x multisampling", antialiasing.samples);
  const std::string super = fmt::format("{0}x{0} supersampling", antialiasing.grid);
  if (antialiasing.grid == 1) return antialiasing.samples == 1 ? "none" : multi;
  return antialiasing.samples == 1 ? super : super + " of " + multi;
}

std::span<const std::string_view> quality_names() { return names; }

Detail detail_of(std::string_view quality) {
  if (quality == "draft") return draft;
  if (quality == "standard") return {};
  if (quality == "final") return final_detail;
  throw std::invalid_argument(fmt::format("unknown quality '{}' (allowed: draft, standard, final)", quality));
}

}  // namespace deforma
