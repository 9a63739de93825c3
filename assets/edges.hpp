#pragma once

#include <cstdint>
#include <vector>

#include "assets/mesh.hpp"

namespace deforma {

/// An edge with a < b, and how many triangles run along it from a to b and back.
struct Edge {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  int forward = 0;
  int backward = 0;
};

/// Every edge of the mesh once, sorted by (a, b).
std::vector<Edge> edges_of(const Mesh& mesh);

/// @throws std::invalid_argument for a triangle that names a missing point, or a point that is not finite.
void check_indices(const Mesh& mesh);

}  // namespace deforma
