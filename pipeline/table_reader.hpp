#pragma once

#include <toml++/toml.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/user_error.hpp"
#include "sim/curve.hpp"
#include "sim/parameters.hpp"
#include "sim/types.hpp"

namespace deforma {

/// "scene.toml:14", or the --set that a node came from.
std::string location(const toml::node& node);

/// @throws UserError "LOCATION: PATH: MESSAGE".
[[noreturn]] void fail(const toml::node& node, std::string_view path, std::string_view message);

/// What a node holds, for messages: "a text", "3.5", ...
std::string found_text(const toml::node& node);

// One value; all throw a UserError with file, line, key, what was found and what is allowed.
double read_number(const toml::node& node, std::string_view path, const Interval& allowed = Interval::any());
Vec3 read_vector(const toml::node& node, std::string_view path);
std::string read_text(const toml::node& node, std::string_view path);
Curve<double> read_number_curve(const toml::node& node, std::string_view path);  ///< may hold nan
Curve<Vec3> read_vector_curve(const toml::node& node, std::string_view path);

/// Reads one table and remembers every key that was asked for, so that a typo cannot pass.
///
/// A key that is absent leaves its value as it was: the default. The writer has the same methods, so that one
/// description of a table serves both ways.
class TableReader {
 public:
  /// @param path what messages call this table, such as "body.elastic"; empty for the whole scene
  TableReader(const toml::table& table, std::string path) : table_(table), path_(std::move(path)) {}

  void value(std::string_view key, double& value, const Interval& allowed = Interval::any());
  void value(std::string_view key, int& value, int low, int high);
  void value(std::string_view key, bool& value);
  void value(std::string_view key, std::string& value);
  void value(std::string_view key, Vec3& value);
  void value(std::string_view key, Curve<Vec3>& value);
  void value(std::string_view key, std::optional<Curve<Vec3>>& value);
  template <typename T, typename... Limits>
  void value(std::string_view key, std::optional<T>& value, const Limits&... limits) {
    if (!take(key)) return;
    T read{};
    this->value(key, read, limits...);
    value = std::move(read);
  }
  void choice(std::string_view key, std::string& value, std::span<const std::string_view> choices);
  void color(std::string_view key, Vec3& rgb);  ///< "#rrggbb" or [r, g, b] in [0, 1]
  /// true for `usual`, false for none, or a colour.
  void color_or_flag(std::string_view key, std::optional<Vec3>& rgb, const Vec3& usual);
  void size(std::string_view key, int& width, int& height);  ///< [width, height] in pixels
  void scale(std::string_view key, Vec3& factors);           ///< one positive number or three
  void range(std::string_view key, std::optional<std::array<double, 2>>& range);  ///< [low, high], finite

  /// Calls `describe(TableReader&)` with the table at `key`, when there is one, and checks that nothing is
  /// left over.
  template <typename Describe>
  void table(std::string_view key, const Describe& describe) {
    const toml::node* node = take(key);
    if (!node) return;
    TableReader reader(as_table(*node, key), path_of(key));
    describe(reader);
    reader.finish();
  }

  /// The tables of an array of tables; a single table counts as one.
  std::vector<const toml::table*> tables(std::string_view key);

  /// The node at `key`, or null; either way the key is one of those allowed.
  const toml::node* take(std::string_view key);

  /// Says that the scene is wrong without this key; told by `finish`, after any typo.
  void require(std::string_view key, std::string_view meaning);

  /// @throws UserError for a key that nobody asked for, with the nearest allowed one, or for a required one
  /// missing.
  void finish() const;

  const toml::table& node() const { return table_; }
  const std::string& path() const { return path_; }
  std::string path_of(std::string_view key) const;

 private:
  const toml::table& as_table(const toml::node& node, std::string_view key) const;

  const toml::table& table_;
  std::string path_;
  std::vector<std::string> known_;
  std::string missing_;
};

}  // namespace deforma
