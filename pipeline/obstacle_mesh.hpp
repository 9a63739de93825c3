#pragma once

#include "assets/mesh.hpp"
#include "sim/obstacle.hpp"

namespace deforma {

/// The surface of an obstacle as drawn, in its own frame. Faces that meet at an edge share no points, so that
/// smooth normals keep the edge; a container's are turned inwards, and an open one has no upper end.
/// @param plane_size edge of the square that stands for a plane [m]
Mesh make_obstacle_mesh(const ObstacleShape& shape, double plane_size);

}  // namespace deforma
