#include "sim/parameters.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace deforma {

namespace {

const Setting& find_setting(std::span<const Setting> settings, std::string_view key) {
  for (const Setting& setting : settings)
    if (setting.key == key) return setting;
  std::vector<std::string_view> keys;
  for (const Setting& setting : settings) keys.push_back(setting.key);
  std::string nearest = nearest_name(key, keys);
  throw std::invalid_argument(fmt::format("unknown key '{}'{} (allowed: {})", key,
                                          nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest),
                                          fmt::join(keys, ", ")));
}

std::string_view type_name(const SettingValue& value) {
  static constexpr std::string_view names[] = {"a number", "a vector of three numbers", "a text",
                                               "true or false", "a region"};
  return names[value.index()];
}

void check_numbers(const Setting& setting, const Curve<double>& curve) {
  const bool may_be_infinite = std::isinf(std::get<Curve<double>>(setting.fallback).at(0.0));
  for (const auto& [time, number] : curve.keys())
    if (!setting.allowed.contains(number) || (std::isinf(number) && !may_be_infinite))
      throw std::invalid_argument(fmt::format("{}: {} is outside {}{}", setting.key, number,
                                              setting.allowed.text(),
                                              setting.unit == "-" ? "" : fmt::format(" {}", setting.unit)));
}

void check_vectors(const Setting& setting, const Curve<Vec3>& curve) {
  for (const auto& [time, vector] : curve.keys())
    if (!vector.allFinite())
      throw std::invalid_argument(
          fmt::format("{}: [{}, {}, {}] is not finite", setting.key, vector.x(), vector.y(), vector.z()));
}

void check(const Setting& setting, const SettingValue& value) {
  if (value.index() != setting.fallback.index())
    throw std::invalid_argument(
        fmt::format("{}: expected {}, found {}", setting.key, type_name(setting.fallback), type_name(value)));
  bool varies = false;
  if (const auto* number = std::get_if<Curve<double>>(&value)) {
    check_numbers(setting, *number);
    varies = number->varies();
  } else if (const auto* vector = std::get_if<Curve<Vec3>>(&value)) {
    check_vectors(setting, *vector);
    varies = vector->varies();
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    if (std::find(setting.choices.begin(), setting.choices.end(), *text) == setting.choices.end()) {
      std::string nearest = nearest_name(*text, setting.choices);
      throw std::invalid_argument(
          fmt::format("{}: unknown choice '{}'{} (allowed: {})", setting.key, *text,
                      nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest),
                      fmt::join(setting.choices, ", ")));
    }
  }
  if (varies && !setting.keyframed)
    throw std::invalid_argument(fmt::format("{}: must be constant, found keyframes", setting.key));
}

}  // namespace

std::string Interval::text() const {
  return fmt::format("{}{}, {}{}", low_open || std::isinf(low) ? '(' : '[', low, high,
                     high_open || std::isinf(high) ? ')' : ']');
}

Parameters::Parameters(std::span<const Setting> settings) : settings_(settings) {}

void Parameters::set(std::string_view key, SettingValue value) {
  check(find_setting(settings_, key), value);
  values_.insert_or_assign(std::string(key), std::move(value));
}

void Parameters::require_complete() const {
  for (const Setting& setting : settings_)
    if (setting.required && !given(setting.key))
      throw std::invalid_argument(
          fmt::format("missing key '{}' ({}, {})", setting.key, setting.meaning, setting.unit));
}

const SettingValue& Parameters::value(std::string_view key) const {
  auto found = values_.find(key);
  return found != values_.end() ? found->second : find_setting(settings_, key).fallback;
}

const Curve<double>& Parameters::number(std::string_view key) const {
  return std::get<Curve<double>>(value(key));
}
const Curve<Vec3>& Parameters::vector(std::string_view key) const {
  return std::get<Curve<Vec3>>(value(key));
}
const std::string& Parameters::text(std::string_view key) const { return std::get<std::string>(value(key)); }
bool Parameters::flag(std::string_view key) const { return std::get<bool>(value(key)); }
const Region& Parameters::region(std::string_view key) const { return std::get<Region>(value(key)); }
bool Parameters::given(std::string_view key) const { return values_.find(key) != values_.end(); }

std::string nearest_name(std::string_view word, std::span<const std::string_view> candidates) {
  std::string_view best;
  std::size_t best_distance = word.size() / 2 + 1;
  for (std::string_view candidate : candidates) {
    // Levenshtein's edit distance, one row at a time.
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t c = 0; c <= candidate.size(); ++c) row[c] = c;
    for (std::size_t w = 1; w <= word.size(); ++w) {
      std::size_t diagonal = row[0];
      row[0] = w;
      for (std::size_t c = 1; c <= candidate.size(); ++c) {
        std::size_t substituted = diagonal + (word[w - 1] != candidate[c - 1]);
        diagonal = row[c];
        row[c] = std::min({row[c] + 1, row[c - 1] + 1, substituted});
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return std::string(best);
}

}  // namespace deforma
