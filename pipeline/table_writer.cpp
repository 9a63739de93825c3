#include "pipeline/table_writer.hpp"

namespace deforma {

toml::array to_array(const Vec3& vector) { return toml::array{vector.x(), vector.y(), vector.z()}; }

namespace {

void insert(toml::table& table, std::string_view key, double value) { table.insert_or_assign(key, value); }
void insert(toml::table& table, std::string_view key, const Vec3& value) {
  table.insert_or_assign(key, to_array(value));
}
void insert(toml::table& table, std::string_view key, bool value) { table.insert_or_assign(key, value); }
void insert(toml::table& table, std::string_view key, const std::string& value) {
  table.insert_or_assign(key, value);
}

void insert(toml::table& table, std::string_view key, const Region& region) {
  toml::table inner{{"min", to_array(region.min)},
                    {"max", to_array(region.max)},
                    {"center", to_array(region.center)},
                    {"radius", region.radius}};
  inner.is_inline(true);
  table.insert_or_assign(key, std::move(inner));
}

void push_key(toml::array& keys, double time, double value) { keys.push_back(toml::array{time, value}); }
void push_key(toml::array& keys, double time, const Vec3& value) {
  keys.push_back(toml::array{time, to_array(value)});
}

template <typename T>
void insert(toml::table& table, std::string_view key, const Curve<T>& curve) {
  if (!curve.varies()) return insert(table, key, curve.keys().front().second);
  toml::array keys;
  for (const auto& [time, value] : curve.keys()) push_key(keys, time, value);
  table.insert_or_assign(key, std::move(keys));
}

}  // namespace

void TableWriter::put(std::string_view key, const Vec3& value) { insert(table_, key, value); }
void TableWriter::put(std::string_view key, const Curve<Vec3>& value) { insert(table_, key, value); }

toml::table to_table(const Parameters& parameters) {
  toml::table table;
  for (const Setting& setting : parameters.settings()) {
    if (setting.derived && !parameters.given(setting.key)) continue;
    std::visit([&](const auto& value) { insert(table, setting.key, value); }, parameters.value(setting.key));
  }
  return table;
}

}  // namespace deforma
