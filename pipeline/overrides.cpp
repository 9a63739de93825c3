#include "pipeline/overrides.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <charconv>

#include "pipeline/user_error.hpp"
#include "sim/effects/registry.hpp"

namespace deforma {

namespace {

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t dot; (dot = path.find('.', begin)) != path.npos; begin = dot + 1)
    parts.push_back(path.substr(begin, dot - begin));
  parts.push_back(path.substr(begin));
  return parts;
}

std::string quoted(const std::string& key) {
  std::string text = "\"";
  for (char c : key) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

/// `keys = value` as nested tables under the first key, each node knowing the option it came from.
toml::table parse_nested(std::span<const std::string> keys, const Override& given) {
  std::vector<std::string> names;
  for (const std::string& key : keys) names.push_back(quoted(key));
  std::string left = fmt::format("{} = ", fmt::join(names, "."));
  try {
    toml::table parsed = toml::parse(left + given.value, given.origin);
    if (parsed.size() == 1) return parsed;
  } catch (const toml::parse_error&) {
    // Not TOML: then it is meant as text.
  }
  return toml::parse(left + quoted(given.value), given.origin);
}

/// What a body or an obstacle is called: by its name, else as the reader will call it.
std::string name_of(const toml::table& table) {
  if (std::optional<std::string> name = table["name"].value<std::string>()) return *name;
  if (std::optional<std::string> mesh = table["mesh"].value<std::string>())
    return std::filesystem::path(*mesh).stem().string();
  return table["shape"]["type"].value_or(std::string());
}

/// The element that an index or a name means.
std::size_t element_index(const toml::array& array, const std::string& key, const Override& given) {
  std::size_t index = 0;
  auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
  if (error == std::errc() && end == key.data() + key.size()) {
    if (index < array.size()) return index;
    throw UserError(
        fmt::format("{}: no element {}; the list has {}, counted from 0", given.origin, key, array.size()));
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < array.size(); ++i) {
    const toml::table* table = array[i].as_table();
    std::string name = table ? name_of(*table) : std::string();
    if (name == key) return i;
    if (!name.empty()) names.push_back(name);
  }
  throw UserError(fmt::format("{}: no element '{}'{} (named: {}; or a number from 0 to {})", given.origin,
                              key, did_you_mean(key, names),
                              names.empty() ? "none" : fmt::to_string(fmt::join(names, ", ")),
                              array.empty() ? 0 : array.size() - 1));
}

/// Turns what an effect's value stands for (its first key; `true` for none) into a table that can be added to.
toml::node* spell_out(toml::table& owner, const std::string& effect) {
  toml::node* node = owner.get(effect);
  const toml::array* array = node->as_array();
  if (node->is_table() || (array && array->is_homogeneous<toml::table>())) return node;
  for (const EffectInfo& info : effect_registry()) {
    if (info.name != effect) continue;
    toml::table table;
    if (!node->is_boolean())
      node->visit([&](const auto& value) { table.insert(info.settings.front().key, value); });
    return &owner.insert_or_assign(effect, std::move(table)).first->second;
  }
  return node;
}

}  // namespace

Override parse_override(const std::string& argument) {
  std::size_t equals = argument.find('=');
  if (equals == argument.npos || equals == 0)
    throw UserError(fmt::format("--set {}: expected KEY=VALUE, such as body.0.density=500", argument));
  return {argument.substr(0, equals), argument.substr(equals + 1), "--set " + argument};
}

void apply_override(toml::table& scene, const Override& given) {
  std::vector<std::string> keys = split(given.key);
  toml::node* node = &scene;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const std::string& key = keys[k];
    if (key.empty()) throw UserError(fmt::format("{}: empty part in the path '{}'", given.origin, given.key));
    bool last = k + 1 == keys.size();
    if (toml::table* table = node->as_table()) {
      if (last || !table->contains(key)) {
        toml::table nested = parse_nested(std::span(keys).subspan(k), given);
        table->insert_or_assign(key, std::move(*nested.get(key)));
        return;
      }
      node = spell_out(*table, key);
    } else if (toml::array* array = node->as_array()) {
      std::size_t index = element_index(*array, key, given);
      if (last) {
        toml::table parsed = parse_nested(std::span(keys).subspan(k), given);
        array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(index), std::move(*parsed.get(key)));
        return;
      }
      node = array->get(index);
    } else {
      throw UserError(fmt::format("{}: '{}' is a value, so it has no '{}'", given.origin,
                                  fmt::join(std::span(keys).first(k), "."), key));
    }
  }
}

}  // namespace deforma
