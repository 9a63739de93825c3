#include <fmt/core.h>

#include <memory>

#include "assets/import.hpp"
#include "pipeline/commands.hpp"
#include "pipeline/files.hpp"
#include "pipeline/user_error.hpp"

namespace deforma {

namespace {

Imported import_or_explain(const std::string& name) {
  // Relative to where the user is: as a scene in this folder would find it.
  std::filesystem::path scene_here = "scene.toml";
  std::filesystem::path file = find_mesh(name, scene_here);
  if (file.empty()) throw UserError(missing_mesh_message(name, scene_here));
  try {
    return import_mesh(file);
  } catch (const std::runtime_error& error) {
    throw UserError(error.what());
  }
}

}  // namespace

int print_mesh(const std::string& name) {
  Imported imported = import_or_explain(name);
  MeshFacts facts = inspect(imported.mesh);
  Eigen::Vector3d size = facts.max - facts.min;
  fmt::print("{}\n", name);
  fmt::print("triangles            {}\n", imported.mesh.triangles.size());
  fmt::print("vertices             {}\n", imported.mesh.points.size());
  fmt::print("boundary edges       {}{}\n", facts.boundary_edges,
             facts.boundary_edges == 0 ? " (closed)" : " (open)");
  fmt::print("non-manifold edges   {}\n", facts.non_manifold_edges);
  fmt::print("components           {}\n", facts.components);
  fmt::print("volume               {:.6g} m3{}\n", facts.volume, facts.volume < 0 ? " (inside-out)" : "");
  fmt::print("area                 {:.6g} m2\n", facts.area);
  fmt::print("bounds               [{:.6g}, {:.6g}, {:.6g}] to [{:.6g}, {:.6g}, {:.6g}] m\n", facts.min.x(),
             facts.min.y(), facts.min.z(), facts.max.x(), facts.max.y(), facts.max.z());
  fmt::print("size                 {:.6g} x {:.6g} x {:.6g} m\n", size.x(), size.y(), size.z());
  fmt::print(
      "on the way in        {} meshes merged, {} polygons triangulated, {} vertices welded, {} triangles "
      "without area dropped\n",
      imported.meshes, imported.polygons, imported.welded_points, imported.dropped_triangles);
  for (const std::string& warning : imported.warnings) fmt::print(stderr, "warning: {}\n", warning);
  return exit_ok;
}

}  // namespace deforma
