#include "pipeline/files.hpp"
#include "pipeline/scene.hpp"
#include "pipeline/scene_keys.hpp"
#include "pipeline/table_writer.hpp"
#include "pipeline/toml_text.hpp"

namespace deforma {

namespace {

toml::array inline_tables(const std::vector<SceneEffect>& effects, std::string_view name) {
  toml::array tables;
  for (const SceneEffect& effect : effects)
    if (effect.info->name == name) tables.push_back(to_table(effect.parameters));
  return tables;
}

void write_effects(toml::table& table, const std::vector<SceneEffect>& effects) {
  for (const SceneEffect& effect : effects) {
    if (table.contains(effect.info->name)) continue;
    toml::array tables = inline_tables(effects, effect.info->name);
    if (tables.size() == 1)
      table.insert_or_assign(effect.info->name, std::move(*tables[0].as_table()));
    else
      table.insert_or_assign(effect.info->name, std::move(tables));
  }
}

/// An installed mesh is found by its name from anywhere, any other by its whole path.
std::string portable_mesh_name(const std::filesystem::path& file) {
  return is_installed_mesh(file) ? file.filename().string()
                                 : std::filesystem::absolute(file).lexically_normal().string();
}

toml::table write_body(SceneBody body) {
  TableWriter writer;
  describe(writer, body);
  toml::table& table = writer.result();
  if (body.mesh) table.insert_or_assign("mesh", portable_mesh_name(body.mesh_file));
  if (body.shape) {
    toml::table shape = to_table(body.shape->parameters);
    shape.insert_or_assign("type", body.shape->info->name);
    table.insert_or_assign("shape", std::move(shape));
  }
  write_effects(table, body.effects);
  for (std::string_view name : body.without) table.insert_or_assign(name, false);
  return std::move(table);
}

toml::table write_obstacle(SceneObstacle obstacle) {
  TableWriter writer;
  describe(writer, obstacle);
  toml::table& table = writer.result();
  toml::table shape = to_table(obstacle.parameters);
  shape.insert_or_assign("type", obstacle.info->name);
  if (obstacle.info->from_file) shape.insert_or_assign("file", portable_mesh_name(obstacle.mesh_file));
  table.insert_or_assign("shape", std::move(shape));
  return std::move(table);
}

toml::table to_table(Scene scene) {
  TableWriter writer;
  describe(writer, scene);
  if (scene.ground) writer.table("ground", [&](TableWriter& inner) { describe(inner, *scene.ground); });
  toml::table& table = writer.result();
  toml::table world;
  write_effects(world, scene.world);
  if (!world.empty()) table.insert_or_assign("world", std::move(world));
  toml::array bodies, obstacles;
  for (const SceneBody& body : scene.bodies) bodies.push_back(write_body(body));
  for (const SceneObstacle& obstacle : scene.obstacles) obstacles.push_back(write_obstacle(obstacle));
  table.insert_or_assign("body", std::move(bodies));
  if (!obstacles.empty()) table.insert_or_assign("obstacle", std::move(obstacles));
  return std::move(table);
}

}  // namespace

std::string scene_to_toml(const Scene& scene) { return to_toml_text(to_table(scene)); }

std::string scene_to_json(const Scene& scene) { return to_json_text(to_table(scene)); }

}  // namespace deforma
