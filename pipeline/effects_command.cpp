#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string>

#include "pipeline/commands.hpp"
#include "sim/effects/registry.hpp"

namespace deforma {

namespace {

std::string text_of(double value) { return fmt::format("{}", value); }
std::string text_of(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

template <typename T>
std::string text_of(const Curve<T>& curve) {
  return text_of(curve.at(0.0));
}
std::string text_of(const std::string& text) { return fmt::format("\"{}\"", text); }
std::string text_of(bool flag) { return flag ? "true" : "false"; }
std::string text_of(const Region&) { return "everywhere"; }

std::string default_of(const Setting& setting) {
  if (setting.required) return "required";
  if (setting.derived) return "computed";
  return std::visit([](const auto& value) { return text_of(value); }, setting.fallback);
}

/// What a setting takes, when that is less than every value of its type.
std::string range_of(const Setting& setting) {
  std::string range;
  if (!setting.choices.empty()) range = fmt::format("{}", fmt::join(setting.choices, " | "));
  bool number = std::holds_alternative<Curve<double>>(setting.fallback);
  if (number && (std::isfinite(setting.allowed.low) || std::isfinite(setting.allowed.high)))
    range = setting.allowed.text();
  bool may_vary = number || std::holds_alternative<Curve<Vec3>>(setting.fallback);
  if (may_vary && setting.keyframed) range += range.empty() ? "or keyframes" : ", or keyframes";
  return range;
}

}  // namespace

int print_effects() {
  fmt::print(
      "Effects, in the order in which they run. A body or [world] has one exactly when it has its table:\n"
      "    NAME = {{ key = value, ... }}   or NAME = value for its first key, or NAME = true for all "
      "defaults\n");
  for (const EffectInfo& info : effect_registry()) {
    fmt::print("\n{}: {}{}{}\n", info.name, info.summary, info.in_world ? " [body or world]" : " [body]",
               info.several ? " [may stand several times]" : "");
    for (const Setting& s : info.settings)
      fmt::print("    {:<16} {:<9} {:<14} {:<28} {}\n", s.key, s.unit, default_of(s), range_of(s), s.meaning);
  }
  return exit_ok;
}

}  // namespace deforma
