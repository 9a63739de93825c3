#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/encoding_keys.hpp"
#include "pipeline/files.hpp"
#include "pipeline/overrides.hpp"
#include "pipeline/scene.hpp"
#include "pipeline/scene_keys.hpp"
#include "pipeline/settings_table.hpp"
#include "pipeline/toml_text.hpp"

namespace deforma {

namespace {

/// The row of a registry that `type` names.
template <typename Info>
const Info& read_type(TableReader& reader, std::span<const Info> registry) {
  std::vector<std::string_view> names;
  for (const Info& info : registry) names.push_back(info.name);
  const toml::node* node = reader.take("type");
  if (!node)
    fail(reader.node(), reader.path(), fmt::format("missing key 'type' (one of {})", fmt::join(names, ", ")));
  std::string type;
  reader.choice("type", type, names);
  return registry[static_cast<std::size_t>(std::find(names.begin(), names.end(), type) - names.begin())];
}

std::filesystem::path locate_mesh(const toml::node& node, const std::string& path, const std::string& name,
                                  const std::filesystem::path& scene_file) {
  std::filesystem::path file = find_mesh(name, scene_file);
  if (file.empty()) fail(node, path, missing_mesh_message(name, scene_file));
  return file;
}

std::vector<SceneEffect> read_effects(TableReader& reader, bool world,
                                      std::vector<std::string_view>* without) {
  std::vector<SceneEffect> effects;
  for (const EffectInfo& info : effect_registry()) {
    if (world && !info.in_world) continue;
    const toml::node* node = reader.take(info.name);
    if (!node) continue;
    std::string path = reader.path_of(info.name);
    auto add = [&](const toml::node& one) {
      effects.push_back(
          {&info, read_parameters(one, info.settings, path), fmt::format("{}: {}", location(one), path)});
    };
    const toml::value<bool>* flag = node->as_boolean();
    const toml::array* array = node->as_array();
    if (flag && !flag->get()) {
      if (without) without->push_back(info.name);
    } else if (array && !array->empty() && array->is_homogeneous(toml::node_type::table)) {
      if (!info.several && array->size() > 1)
        fail(*node, path, fmt::format("may stand only once, found {} tables", array->size()));
      for (const toml::node& one : *array) add(one);
    } else {
      add(*node);
    }
  }
  return effects;
}

bool has_effect(const std::vector<SceneEffect>& effects, std::string_view name) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const SceneEffect& e) { return e.info->name == name; });
}

/// An elastic body without hourglass control has modes that cost no energy, so it gets that one effect
/// unasked.
void add_hourglass(SceneBody& body) {
  const EffectInfo& hourglass = find_effect("hourglass");
  bool refused = std::find(body.without.begin(), body.without.end(), hourglass.name) != body.without.end();
  if (!has_effect(body.effects, "elastic") || has_effect(body.effects, hourglass.name) || refused) return;
  auto later = std::find_if(body.effects.begin(), body.effects.end(),
                            [&](const SceneEffect& e) { return e.info > &hourglass; });
  body.effects.insert(later, {&hourglass, Parameters(hourglass.settings), body.where + ".hourglass"});
}

Vec3 body_color(std::size_t index) {
  static const std::array<Vec3, 6> palette = {Vec3(0.80, 0.35, 0.20), Vec3(0.20, 0.47, 0.70),
                                              Vec3(0.36, 0.60, 0.28), Vec3(0.85, 0.62, 0.18),
                                              Vec3(0.55, 0.36, 0.65), Vec3(0.25, 0.60, 0.60)};
  return palette[index % palette.size()];
}

SceneBody read_body(const toml::table& table, const Scene& scene) {
  SceneBody body;
  body.where = fmt::format("{}: body", location(table));
  body.look.color = body_color(scene.bodies.size());
  TableReader reader(table, "body");
  reader.value("mesh", body.mesh);
  reader.table("shape", [&](TableReader& inner) {
    const ShapeInfo& info = read_type(inner, shape_registry());
    body.shape = SceneShape{&info, read_settings(inner, info.settings)};
  });
  describe(reader, body);
  body.effects = read_effects(reader, false, &body.without);
  reader.finish();

  if (body.mesh.has_value() == body.shape.has_value())
    fail(table, "body",
         fmt::format("expected exactly one of 'mesh' and 'shape', found {}", body.mesh ? "both" : "none"));
  if (body.particles.has_value() == body.spacing.has_value())
    fail(table, "body",
         fmt::format("expected exactly one of 'particles' and 'spacing', found {}",
                     body.particles ? "both" : "none"));
  if (body.subdivide > 0 && body.surface_particles)
    fail(table, "body", "expected at most one of 'subdivide' and 'surface_particles', found both");
  if (body.mesh) {
    body.mesh_where = fmt::format("{}: body.mesh", location(*table.get("mesh")));
    body.mesh_file = locate_mesh(*table.get("mesh"), "body.mesh", *body.mesh, scene.file);
  }
  if (body.shape) body.mesh_where = fmt::format("{}: body.shape", location(*table.get("shape")));
  if (body.name.empty())
    body.name = body.mesh ? body.mesh_file.stem().string() : std::string(body.shape->info->name);
  add_hourglass(body);
  return body;
}

const LookSpec glass_look = {{0.72, 0.85, 0.95}, 0.18, 0.15, false};
const LookSpec solid_look = {{0.55, 0.57, 0.60}, 1.0, 0.6, false};

ObstacleShape make_obstacle_shape(const SceneObstacle& obstacle, const toml::node& node) {
  try {
    return obstacle.info->make(obstacle.parameters, {});
  } catch (const std::invalid_argument& error) {
    fail(node, "", fmt::format("obstacle.shape.{}", error.what()));
  }
}

SceneObstacle read_obstacle(const toml::table& table, const Scene& scene) {
  SceneObstacle obstacle;
  obstacle.where = fmt::format("{}: obstacle", location(table));
  TableReader reader(table, "obstacle");
  reader.require("shape", "a table with its type and sizes");
  reader.table("shape", [&](TableReader& inner) {
    obstacle.info = &read_type(inner, obstacle_registry());
    obstacle.parameters = read_settings(inner, obstacle.info->settings);
    if (!obstacle.info->from_file) return;
    inner.require("file", "the mesh");
    inner.value("file", obstacle.mesh);
    if (const toml::node* file = inner.take("file")) {
      obstacle.where = fmt::format("{}: {}", location(*file), inner.path_of("file"));
      obstacle.mesh_file = locate_mesh(*file, inner.path_of("file"), obstacle.mesh, scene.file);
    }
  });
  if (obstacle.info) {
    obstacle.name = obstacle.info->name;
    bool glass =
        !obstacle.info->from_file && is_container(make_obstacle_shape(obstacle, *table.get("shape")));
    obstacle.look = glass ? glass_look : solid_look;
  }
  describe(reader, obstacle);
  reader.finish();
  return obstacle;
}

/// Gives default names a number where they clash, and refuses given names that do.
template <typename Named>
void check_names(std::vector<Named>& things, const std::vector<const toml::table*>& tables,
                 std::string_view what) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    auto taken = [&](const std::string& name) {
      return std::any_of(things.begin(), things.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const Named& other) { return other.name == name; });
    };
    if (!taken(things[i].name)) continue;
    if (const toml::node* given = tables[i]->get("name"))
      fail(*given, fmt::format("{}.name", what),
           fmt::format("'{}' is taken by an earlier {}", things[i].name, what));
    int number = 2;
    while (taken(fmt::format("{}_{}", things[i].name, number))) ++number;
    things[i].name = fmt::format("{}_{}", things[i].name, number);
  }
}

}  // namespace

int Scene::frames() const { return std::max(1, static_cast<int>(std::lround(duration * fps))); }

Scene load_scene(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  toml::table root = parse_toml_file(file);
  for (const Override& given : overrides) apply_override(root, given);

  Scene scene;
  scene.file = file;
  scene.name = file.stem().string();
  TableReader reader(root, "");
  describe(reader, scene);
  if (reader.take("ground")) scene.ground = GroundSpec{};
  reader.table("ground", [&](TableReader& inner) { describe(inner, *scene.ground); });
  reader.table("world", [&](TableReader& inner) { scene.world = read_effects(inner, true, nullptr); });
  std::vector<const toml::table*> bodies = reader.tables("body");
  std::vector<const toml::table*> obstacles = reader.tables("obstacle");
  reader.finish();
  resolve_encoding(root, scene.output);
  if (scene.camera.height && scene.camera.projection != "orthographic")
    fail(
        *root["camera"]["height"].node(), "camera.height",
        fmt::format("counts only with projection = \"orthographic\", found \"{}\"", scene.camera.projection));
  if (bodies.empty())
    throw UserError(fmt::format("{}: no [[body]]: a scene needs at least one", file.string()));
  if (scene.duration * scene.fps > 1e6)
    fail(*root.get("duration"), "duration",
         fmt::format("{} s at {} frames per second are more than a million frames", scene.duration,
                     scene.fps));

  for (const toml::table* table : bodies) scene.bodies.push_back(read_body(*table, scene));
  for (const toml::table* table : obstacles) scene.obstacles.push_back(read_obstacle(*table, scene));
  check_names(scene.bodies, bodies, "body");
  check_names(scene.obstacles, obstacles, "obstacle");
  return scene;
}

}  // namespace deforma
