#include "pipeline/table_reader.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "pipeline/toml_text.hpp"

namespace deforma {

std::string location(const toml::node& node) {
  const toml::source_region& source = node.source();
  if (!source.path) return "scene";
  bool from_option = source.path->rfind("--", 0) == 0;
  if (from_option || source.begin.line == 0) return *source.path;
  return fmt::format("{}:{}", *source.path, source.begin.line);
}

void fail(const toml::node& node, std::string_view path, std::string_view message) {
  throw UserError(path.empty() ? fmt::format("{}: {}", location(node), message)
                               : fmt::format("{}: {}: {}", location(node), path, message));
}

std::string found_text(const toml::node& node) {
  if (node.is_table()) return "a table";
  std::string found = to_inline_text(node);
  constexpr std::size_t longest = 60;
  return found.size() <= longest ? found : found.substr(0, longest) + "...";
}

namespace {

/// A number, possibly nan: for what is checked against its interval, which refuses nan, by others.
double read_any_number(const toml::node& node, std::string_view path) {
  std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value) fail(node, path, fmt::format("expected a number, found {}", found_text(node)));
  return *value;
}

}  // namespace

double read_number(const toml::node& node, std::string_view path, const Interval& allowed) {
  double value = read_any_number(node, path);
  if (!allowed.contains(value)) fail(node, path, fmt::format("{} is outside {}", value, allowed.text()));
  return value;
}

Vec3 read_vector(const toml::node& node, std::string_view path) {
  const toml::array* array = node.as_array();
  if (!array || array->size() != 3)
    fail(node, path, fmt::format("expected three numbers [x, y, z], found {}", found_text(node)));
  Vec3 vector;
  for (int c = 0; c < 3; ++c) vector[c] = read_number((*array)[c], path);
  return vector;
}

std::string read_text(const toml::node& node, std::string_view path) {
  const toml::value<std::string>* text = node.as_string();
  if (!text) fail(node, path, fmt::format("expected a text in quotes, found {}", found_text(node)));
  return text->get();
}

namespace {

/// [[time, value], ...] as a curve; the first element of a constant vector is a number, that of keyframes an
/// array.
template <typename T, typename ReadValue>
Curve<T> read_keyframes(const toml::array& array, std::string_view path, const ReadValue& read) {
  std::vector<typename Curve<T>::Key> keys;
  for (const toml::node& element : array) {
    const toml::array* pair = element.as_array();
    if (!pair || pair->size() != 2)
      fail(element, path, fmt::format("expected a keyframe [time, value], found {}", found_text(element)));
    keys.emplace_back(read_number((*pair)[0], path), read((*pair)[1], path));
  }
  try {
    return Curve<T>(std::move(keys));
  } catch (const std::invalid_argument& error) {
    fail(array, path, error.what());
  }
}

}  // namespace

Curve<double> read_number_curve(const toml::node& node, std::string_view path) {
  const toml::array* array = node.as_array();
  if (!array) {
    if (!node.is_number())
      fail(node, path,
           fmt::format("expected a number or keyframes [[time, value], ...], found {}", found_text(node)));
    return read_any_number(node, path);
  }
  return read_keyframes<double>(*array, path, read_any_number);
}

Curve<Vec3> read_vector_curve(const toml::node& node, std::string_view path) {
  const toml::array* array = node.as_array();
  bool keyframes = array && !array->empty() && (*array)[0].is_array();
  if (!keyframes) {
    if (!array || array->size() != 3)
      fail(node, path,
           fmt::format("expected [x, y, z] or keyframes [[time, [x, y, z]], ...], found {}",
                       found_text(node)));
    return read_vector(node, path);
  }
  return read_keyframes<Vec3>(
      *array, path, [](const toml::node& n, std::string_view where) { return read_vector(n, where); });
}

const toml::node* TableReader::take(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return table_.get(key);
}

std::string TableReader::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void TableReader::value(std::string_view key, double& value, const Interval& allowed) {
  if (const toml::node* node = take(key)) {
    value = read_number(*node, path_of(key), allowed);
    if (std::isinf(value)) fail(*node, path_of(key), fmt::format("{} is not finite", value));
  }
}

void TableReader::value(std::string_view key, int& value, int low, int high) {
  const toml::node* node = take(key);
  if (!node) return;
  const toml::value<std::int64_t>* integer = node->as_integer();
  if (!integer)
    fail(*node, path_of(key), fmt::format("expected a whole number, found {}", found_text(*node)));
  if (integer->get() < low || integer->get() > high)
    fail(*node, path_of(key), fmt::format("{} is outside [{}, {}]", integer->get(), low, high));
  value = static_cast<int>(integer->get());
}

void TableReader::value(std::string_view key, bool& value) {
  const toml::node* node = take(key);
  if (!node) return;
  const toml::value<bool>* flag = node->as_boolean();
  if (!flag) fail(*node, path_of(key), fmt::format("expected true or false, found {}", found_text(*node)));
  value = flag->get();
}

void TableReader::value(std::string_view key, std::string& value) {
  if (const toml::node* node = take(key)) value = read_text(*node, path_of(key));
}

void TableReader::value(std::string_view key, Vec3& value) {
  const toml::node* node = take(key);
  if (!node) return;
  value = read_vector(*node, path_of(key));
  if (!value.allFinite()) fail(*node, path_of(key), fmt::format("{} is not finite", found_text(*node)));
}

void TableReader::value(std::string_view key, Curve<Vec3>& value) {
  const toml::node* node = take(key);
  if (!node) return;
  value = read_vector_curve(*node, path_of(key));
  for (const auto& [time, vector] : value.keys())
    if (!vector.allFinite()) fail(*node, path_of(key), fmt::format("{} is not finite", found_text(*node)));
}

void TableReader::value(std::string_view key, std::optional<Curve<Vec3>>& value) {
  if (!take(key)) return;
  Curve<Vec3> read = Vec3(0, 0, 0);
  this->value(key, read);
  value = std::move(read);
}

void TableReader::choice(std::string_view key, std::string& value,
                         std::span<const std::string_view> choices) {
  const toml::node* node = take(key);
  if (!node) return;
  if (!node->is_string())
    fail(*node, path_of(key),
         fmt::format("expected a text in quotes, found {} (allowed: {})", found_text(*node),
                     fmt::join(choices, ", ")));
  value = read_text(*node, path_of(key));
  if (std::find(choices.begin(), choices.end(), value) == choices.end())
    fail(*node, path_of(key),
         fmt::format("unknown choice '{}'{} (allowed: {})", value, did_you_mean(value, choices),
                     fmt::join(choices, ", ")));
}

namespace {

/// @param also what else is allowed, for messages
Vec3 read_color(const toml::node& node, const std::string& path, std::string_view also = "") {
  auto refuse = [&](const std::string& found) {
    fail(node, path,
         fmt::format("expected {}a colour \"#rrggbb\" or [r, g, b] in [0, 1], found {}", also, found));
  };
  Vec3 rgb;
  if (const toml::value<std::string>* text = node.as_string()) {
    const std::string& hex = text->get();
    bool valid =
        hex.size() == 7 && hex[0] == '#' && hex.find_first_not_of("0123456789abcdefABCDEF", 1) == hex.npos;
    if (!valid) refuse(fmt::format("'{}'", hex));
    for (int c = 0; c < 3; ++c) rgb[c] = std::stoi(hex.substr(1 + 2 * c, 2), nullptr, 16) / 255.0;
    return rgb;
  }
  const toml::array* array = node.as_array();
  if (!array || array->size() != 3) refuse(found_text(node));
  for (int c = 0; c < 3; ++c) rgb[c] = read_number((*array)[c], path, Interval::closed(0.0, 1.0));
  return rgb;
}

}  // namespace

void TableReader::color(std::string_view key, Vec3& rgb) {
  if (const toml::node* node = take(key)) rgb = read_color(*node, path_of(key));
}

void TableReader::color_or_flag(std::string_view key, std::optional<Vec3>& rgb, const Vec3& usual) {
  const toml::node* node = take(key);
  if (!node) return;
  if (const toml::value<bool>* flag = node->as_boolean())
    rgb = flag->get() ? std::optional<Vec3>(usual) : std::nullopt;
  else
    rgb = read_color(*node, path_of(key), "true, false or ");
}

void TableReader::size(std::string_view key, int& width, int& height) {
  const toml::node* node = take(key);
  if (!node) return;
  std::string path = path_of(key);
  const toml::array* array = node->as_array();
  if (!array || array->size() != 2 || !(*array)[0].is_integer() || !(*array)[1].is_integer())
    fail(*node, path, fmt::format("expected two whole numbers [width, height], found {}", found_text(*node)));
  constexpr std::int64_t largest = 16384;
  for (int c = 0; c < 2; ++c) {
    std::int64_t pixels = (*array)[c].as_integer()->get();
    if (pixels < 1 || pixels > largest)
      fail(*node, path, fmt::format("{} pixels is outside [1, {}]", pixels, largest));
    (c == 0 ? width : height) = static_cast<int>(pixels);
  }
}

void TableReader::scale(std::string_view key, Vec3& factors) {
  const toml::node* node = take(key);
  if (!node) return;
  std::string path = path_of(key);
  if (node->is_number())
    factors.setConstant(read_number(*node, path));
  else
    factors = read_vector(*node, path);
  if (!factors.allFinite() || factors.minCoeff() <= 0.0)
    fail(*node, path, fmt::format("{} is outside (0, inf)", found_text(*node)));
}

void TableReader::range(std::string_view key, std::optional<std::array<double, 2>>& range) {
  const toml::node* node = take(key);
  if (!node) return;
  const std::string path = path_of(key);
  const toml::array* array = node->as_array();
  if (!array || array->size() != 2)
    fail(*node, path, fmt::format("expected two numbers [low, high], found {}", found_text(*node)));
  const double low = read_number((*array)[0], path), high = read_number((*array)[1], path);
  if (!std::isfinite(low) || !std::isfinite(high) || !(low < high))
    fail(*node, path, fmt::format("expected low below high, both finite, found {}", found_text(*node)));
  range = {low, high};
}

std::vector<const toml::table*> TableReader::tables(std::string_view key) {
  std::vector<const toml::table*> found;
  const toml::node* node = take(key);
  if (!node) return found;
  if (const toml::table* single = node->as_table()) return {single};
  const toml::array* array = node->as_array();
  if (!array)
    fail(*node, path_of(key), fmt::format("expected [[{}]] tables, found {}", key, found_text(*node)));
  for (const toml::node& element : *array) found.push_back(&as_table(element, key));
  return found;
}

const toml::table& TableReader::as_table(const toml::node& node, std::string_view key) const {
  const toml::table* table = node.as_table();
  if (!table) fail(node, path_of(key), fmt::format("expected a table, found {}", found_text(node)));
  return *table;
}

void TableReader::require(std::string_view key, std::string_view meaning) {
  if (!take(key) && missing_.empty()) missing_ = fmt::format("missing key '{}' ({})", key, meaning);
}

void TableReader::finish() const {
  for (const auto& [key, node] : table_)
    if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
      fail(node, path_,
           fmt::format("unknown key '{}'{} (allowed: {})", key.str(), did_you_mean(key.str(), known_),
                       fmt::join(known_, ", ")));
  if (!missing_.empty()) fail(table_, path_, missing_);
}

}  // namespace deforma
