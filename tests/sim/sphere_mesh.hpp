#pragma once

#include <map>

#include "sim/obstacle.hpp"

namespace deforma {

/// An octahedron on the sphere, each triangle divided in four `levels` times.
inline MeshShape sphere_mesh(double radius, int levels) {
  MeshShape mesh;
  mesh.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    auto middle = [&](Index a, Index b) {
      auto [place, added] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.points.size()));
      if (added) mesh.points.push_back((mesh.points[a] + mesh.points[b]).normalized());
      return place->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.points) p *= radius;
  return mesh;
}

}  // namespace deforma
