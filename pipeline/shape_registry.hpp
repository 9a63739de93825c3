#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "assets/mesh.hpp"
#include "sim/obstacle.hpp"
#include "sim/parameters.hpp"

namespace deforma {

/// One row of the table of built-in bodies: `shape = { type = "NAME", ... }`.
struct ShapeInfo {
  std::string_view name;
  std::span<const Setting> settings;
  Mesh (*make)(const Parameters& parameters);
};

std::span<const ShapeInfo> shape_registry();

/// One row of the table of obstacles.
struct ObstacleInfo {
  std::string_view name;
  std::span<const Setting> settings;
  bool from_file;  ///< then a `file` names its mesh
  /// @param file empty unless `from_file`
  /// @throws std::invalid_argument for a size that makes no sense; std::runtime_error as `import_mesh`
  ObstacleShape (*make)(const Parameters& parameters, const std::filesystem::path& file);
};

std::span<const ObstacleInfo> obstacle_registry();

/// Whether bodies are kept inside it.
bool is_container(const ObstacleShape& shape);

}  // namespace deforma
