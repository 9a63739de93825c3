#include "pipeline/settings_table.hpp"

#include <fmt/core.h>

#include <cmath>

namespace deforma {

namespace {

Region read_region(const toml::node& node, const std::string& path) {
  const toml::table* table = node.as_table();
  if (!table)
    fail(node, path,
         fmt::format("expected a region {{ min, max, center, radius }}, found {}", found_text(node)));
  Region region;
  TableReader reader(*table, path);
  // Infinite bounds are allowed here, so the reader's finite vectors do not serve.
  if (const toml::node* min = reader.take("min")) region.min = read_vector(*min, reader.path_of("min"));
  if (const toml::node* max = reader.take("max")) region.max = read_vector(*max, reader.path_of("max"));
  if (const toml::node* center = reader.take("center"))
    region.center = read_vector(*center, reader.path_of("center"));
  if (const toml::node* radius = reader.take("radius"))
    region.radius = read_number(*radius, reader.path_of("radius"), Interval::positive());
  reader.finish();
  for (int axis = 0; axis < 3; ++axis)
    if (!(region.min[axis] <= region.max[axis]))
      fail(node, path,
           fmt::format("no {0} is from min = {1} up to max = {2}; expected min <= max", "xyz"[axis],
                       region.min[axis], region.max[axis]));
  return region;
}

/// Reads a node as whatever the fallback holds.
SettingValue read_as(const toml::node& node, const Setting& setting, const std::string& path) {
  if (const auto* number = std::get_if<Curve<double>>(&setting.fallback)) {
    Curve<double> read = read_number_curve(node, path);
    bool may_be_infinite = std::isinf(number->at(0.0));
    for (const auto& [time, value] : read.keys())
      if (std::isinf(value) && !may_be_infinite && setting.allowed.contains(value))
        fail(node, path, fmt::format("{} is not finite", value));
    return read;
  }
  if (std::holds_alternative<Curve<Vec3>>(setting.fallback)) return read_vector_curve(node, path);
  if (std::holds_alternative<std::string>(setting.fallback)) return read_text(node, path);
  if (std::holds_alternative<bool>(setting.fallback)) {
    const toml::value<bool>* flag = node.as_boolean();
    if (!flag) fail(node, path, fmt::format("expected true or false, found {}", found_text(node)));
    return flag->get();
  }
  return read_region(node, path);
}

void set(Parameters& parameters, const Setting& setting, const toml::node& node, const std::string& path) {
  try {
    parameters.set(setting.key, read_as(node, setting, path));
  } catch (const std::invalid_argument& error) {
    // The message begins with the key, the last part of the path.
    std::string parent = path.substr(0, path.size() - setting.key.size());
    fail(node, "", parent + error.what());
  }
}

}  // namespace

Parameters read_settings(TableReader& reader, std::span<const Setting> settings) {
  Parameters parameters(settings);
  for (const Setting& setting : settings) {
    if (const toml::node* node = reader.take(setting.key))
      set(parameters, setting, *node, reader.path_of(setting.key));
    else if (setting.required)
      reader.require(setting.key, setting.unit == "-" ? std::string(setting.meaning)
                                                      : fmt::format("{}, {}", setting.meaning, setting.unit));
  }
  return parameters;
}

Parameters read_parameters(const toml::node& node, std::span<const Setting> settings,
                           const std::string& path) {
  if (const toml::table* table = node.as_table()) {
    TableReader reader(*table, path);
    Parameters parameters = read_settings(reader, settings);
    reader.finish();
    return parameters;
  }
  Parameters parameters(settings);
  bool first_is_flag = !settings.empty() && std::holds_alternative<bool>(settings.front().fallback);
  if (const toml::value<bool>* flag = node.as_boolean(); !flag || first_is_flag) {
    if (settings.empty()) fail(node, path, "has no settings: write true");
    set(parameters, settings.front(), node, fmt::format("{}.{}", path, settings.front().key));
  }
  try {
    parameters.require_complete();
  } catch (const std::invalid_argument& error) {
    fail(node, path, error.what());
  }
  return parameters;
}

}  // namespace deforma
