#pragma once

#include <toml++/toml.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sim/curve.hpp"
#include "sim/parameters.hpp"
#include "sim/types.hpp"

namespace deforma {

/// Writes one table through the description that reads it: every value with its default filled in.
class TableWriter {
 public:
  template <typename T, typename... Limits>
  void value(std::string_view key, const T& value, const Limits&...) {
    put(key, value);
  }
  template <typename T, typename... Limits>
  void value(std::string_view key, const std::optional<T>& value, const Limits&...) {
    if (value) put(key, *value);
  }
  void choice(std::string_view key, const std::string& value, std::span<const std::string_view>) {
    put(key, value);
  }
  void color(std::string_view key, const Vec3& rgb) { put(key, rgb); }
  void color_or_flag(std::string_view key, const std::optional<Vec3>& rgb, const Vec3&) {
    if (rgb) put(key, *rgb);
  }
  void size(std::string_view key, int width, int height) {
    table_.insert_or_assign(key, toml::array{width, height});
  }
  void scale(std::string_view key, const Vec3& factors) { put(key, factors); }
  void range(std::string_view key, const std::optional<std::array<double, 2>>& range) {
    if (range) table_.insert_or_assign(key, toml::array{(*range)[0], (*range)[1]});
  }
  template <typename Describe>
  void table(std::string_view key, const Describe& describe) {
    TableWriter writer;
    describe(writer);
    table_.insert_or_assign(key, std::move(writer.table_));
  }
  void require(std::string_view, std::string_view) {}

  toml::table& result() { return table_; }

 private:
  void put(std::string_view key, double value) { table_.insert_or_assign(key, value); }
  void put(std::string_view key, int value) { table_.insert_or_assign(key, value); }
  void put(std::string_view key, bool value) { table_.insert_or_assign(key, value); }
  void put(std::string_view key, const std::string& value) { table_.insert_or_assign(key, value); }
  void put(std::string_view key, const Vec3& value);
  void put(std::string_view key, const Curve<Vec3>& value);

  toml::table table_;
};

toml::array to_array(const Vec3& vector);

/// Every key of the settings, those not given with their defaults; a default that is computed stays unwritten,
/// for written it would count as given.
toml::table to_table(const Parameters& parameters);

}  // namespace deforma
