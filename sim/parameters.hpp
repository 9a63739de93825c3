#pragma once

#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/curve.hpp"
#include "sim/region.hpp"
#include "sim/types.hpp"

namespace deforma {

/// What a setting can hold. Numbers and vectors may vary in time; text is one of a list of choices.
using SettingValue = std::variant<Curve<double>, Curve<Vec3>, std::string, bool, Region>;

/// The interval that a number must lie in.
struct Interval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;

  bool contains(double x) const {
    return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
  }
  std::string text() const;  ///< for messages, such as "(-1, 0.5)"

  static Interval any() { return {}; }
  static Interval positive() { return {.low = 0.0, .low_open = true}; }
  static Interval non_negative() { return {.low = 0.0}; }
  static Interval closed(double a, double b) { return {.low = a, .high = b}; }
  static Interval open(double a, double b) { return {a, b, true, true}; }
};

/// One key of an effect's table: the only place where its type, unit, default and allowed range stand.
/// Reading a scene, printing the table of effects and writing the resolved scene all follow it.
struct Setting {
  std::string_view key;
  std::string_view unit;     ///< SI unit, "-" for none
  std::string_view meaning;  ///< one line
  SettingValue fallback;     ///< default, and the type: a given value holds the same alternative
  bool required = false;     ///< then the fallback only gives the type
  Interval allowed = {};     ///< for numbers
  std::vector<std::string_view> choices = {};  ///< for text
  bool keyframed = true;                       ///< numbers and vectors: may it be a list of [time, value]?
  bool derived =
      false;  ///< the default is computed from the rest of the scene; the fallback only gives the type
};

/// The values given to one effect of one body: every key of its settings, defaults filled in.
class Parameters {
 public:
  /// All defaults.
  explicit Parameters(std::span<const Setting> settings);

  /// Replaces one value.
  /// @throws std::invalid_argument naming the key, what was found and what is allowed: an unknown key (with
  /// the
  ///         nearest valid name), another type, a number (at any keyframe) outside the interval or not
  ///         finite, keyframes where none may be, a text that is no choice.
  void set(std::string_view key, SettingValue value);

  /// @throws std::invalid_argument when a required key was never set.
  void require_complete() const;

  const Curve<double>& number(std::string_view key) const;
  const Curve<Vec3>& vector(std::string_view key) const;
  const std::string& text(std::string_view key) const;
  bool flag(std::string_view key) const;
  const Region& region(std::string_view key) const;
  bool given(std::string_view key) const;  ///< set by the scene, not by default

  std::span<const Setting> settings() const { return settings_; }
  const SettingValue& value(std::string_view key) const;

 private:
  std::span<const Setting> settings_;
  std::map<std::string, SettingValue, std::less<>> values_;
};

/// The candidate closest to `word` in edit distance, or empty when none is near (more than half its length).
std::string nearest_name(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace deforma
