#pragma once

#include <cstddef>

#include "assets/mesh.hpp"

namespace deforma {

struct WeldReport {
  std::size_t welded_points = 0;      ///< merged into an earlier point
  std::size_t dropped_triangles = 0;  ///< with a corner twice, or with no height
};

/// Merges points closer than 1e-6 of the diagonal of the bounds, drops triangles without area and then points that no
/// triangle uses. Texture and normal seams store a point once for each side; physics needs it once.
/// The first point of a cluster stays where it is; the order of points and triangles is kept.
WeldReport weld(Mesh& mesh);

}  // namespace deforma
