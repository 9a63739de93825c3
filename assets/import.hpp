#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/mesh.hpp"

namespace deforma {

/// A mesh read from a file, and what was done to it on the way.
struct Imported {
  Mesh mesh;
  std::size_t meshes = 0;             ///< that the file holds, merged with their node transforms
  std::size_t polygons = 0;           ///< faces of more than three corners, triangulated
  std::size_t welded_points = 0;      ///< merged; the reader makes one of every face corner in some formats
  std::size_t dropped_triangles = 0;  ///< without area
  std::vector<std::string> warnings;
};

/// Reads any format that assimp reads: all meshes of the file in one, each where its nodes put it, polygons cut into
/// triangles, duplicate points welded, triangles without area dropped. An inside-out or open mesh stays as it is.
///
/// Coordinates are taken as they stand in the file and mean metres; only COLLADA's declared unit is applied. No axis is
/// turned: z is up in this world, so a file made with y up lies on its back until it is posed.
/// @throws std::runtime_error naming the file and what is wrong with it: missing, empty, no mesh, a non-finite vertex,
///         an index out of range, no triangle left.
Imported import_mesh(const std::filesystem::path& file);

}  // namespace deforma
