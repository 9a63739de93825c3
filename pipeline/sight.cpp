#include "pipeline/sight.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <unordered_map>

namespace deforma {

bool is_convex(const Mesh& mesh) {
  MeshFacts facts = inspect(mesh);
  if (facts.components != 1 || facts.boundary_edges > 0 || facts.non_manifold_edges > 0) return false;
  // A sphere and no torus: Euler's characteristic. Then locally convex everywhere is convex.
  if (2 * mesh.points.size() != mesh.triangles.size() + 4) return false;
  double tolerance = 1e-9 * (facts.max - facts.min).norm();
  std::unordered_map<std::uint64_t, Index> opposite;  // corner of a triangle, by the edge before it
  opposite.reserve(3 * mesh.triangles.size());
  auto along = [](Index from, Index to) { return std::uint64_t{from} << 32 | to; };
  for (const auto& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) opposite[along(t[c], t[(c + 1) % 3])] = t[(c + 2) % 3];
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.points[t[0]];
    Vec3 normal = (mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a).normalized();
    for (int c = 0; c < 3; ++c) {
      const Vec3& beyond = mesh.points[opposite.at(along(t[(c + 1) % 3], t[c]))];
      if (normal.dot(beyond - a) > tolerance) return false;
    }
  }
  return true;
}

Sight::Sight(std::span<const Mesh> meshes, std::span<const Body> bodies) {
  for (std::size_t b = 0; b < meshes.size(); ++b) {
    if (is_convex(meshes[b]))
      visibility_.emplace_back(std::nullopt);
    else
      visibility_.emplace_back(Visibility(meshes[b], bodies[b].spacing, bodies[b].particles.size()));
  }
}

bool Sight::needed() const {
  return std::any_of(visibility_.begin(), visibility_.end(), [](const auto& v) { return v.has_value(); });
}

bool Sight::operator()(Index body, const Vec3& a, const Vec3& b) const {
  const std::optional<Visibility>& visibility = visibility_[body];
  return !visibility || visibility->sees(a, b);
}

}  // namespace deforma
