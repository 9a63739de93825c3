#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>

#include "assets/mesh.hpp"

namespace deforma {

// Closed shapes around the origin, axis along z. Sizes are full lengths or radii in metres.
// All throw std::invalid_argument for sizes that are not positive or resolutions too small.

Mesh make_box(const Eigen::Vector3d& size, int resolution);  ///< resolution: cells along the longest edge
Mesh make_sphere(double radius, int resolution);  ///< resolution: cells along a quarter of the equator
Mesh make_ellipsoid(const Eigen::Vector3d& radii, int resolution);
Mesh make_octahedron(double radius, int resolution);  ///< radius: center to corner; cells along an edge
Mesh make_torus(double radius, double tube_radius, int segments, int rings);

/// Rings of `segments` points; each cap is closed by triangles across its innermost ring, so that there is no pole:
/// V = segments * rings, T = 2V - 4. `rings` counts those on the side and on both caps.
Mesh make_cylinder(double radius, double height, int segments, int rings);

}  // namespace deforma
