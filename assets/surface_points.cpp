#include "assets/surface_points.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "assets/mesh_tree.hpp"

namespace deforma {

namespace {

using Eigen::Vector3d;
using Polygon = std::vector<Vector3d>;

// The part of a convex polygon where sign * (p[axis] - bound) <= 0 (Sutherland & Hodgman 1974).
Polygon clip(const Polygon& polygon, int axis, double bound, double sign) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector3d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da <= 0.0) kept.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
      kept.push_back(a + da / (da - db) * (b - a));
      kept.back()[axis] = bound;
    }
  }
  return kept;
}

/// The triangles of a mesh, clipped by a box.
Mesh clipped(const Mesh& mesh, const SurfacePart& part) {
  Mesh result;
  for (const auto& t : mesh.triangles) {
    Polygon polygon = {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
    for (int axis = 0; axis < 3 && polygon.size() > 2; ++axis) {
      if (std::isfinite(part.min[axis])) polygon = clip(polygon, axis, part.min[axis], -1.0);
      if (std::isfinite(part.max[axis])) polygon = clip(polygon, axis, part.max[axis], 1.0);
    }
    const auto first = static_cast<std::uint32_t>(result.points.size());
    if (polygon.size() < 3) continue;
    result.points.insert(result.points.end(), polygon.begin(), polygon.end());
    for (std::uint32_t k = 2; k < polygon.size(); ++k)
      result.triangles.push_back({first, first + k - 1, first + k});
  }
  return result;
}

bool holds(const SurfacePart& part, const Vector3d& point) {
  return (point.array() >= part.min.array()).all() && (point.array() <= part.max.array()).all() &&
         (point - part.center).norm() <= part.radius;
}

/// Whether a point is at least `apart` from all those kept before; they stand in cubes of that width.
class Spaced {
 public:
  explicit Spaced(double apart) : apart_(apart) {}

  bool keep(const Vector3d& point) {
    const Key cube = (point / apart_).array().floor().cast<long>().matrix();
    for (long x = -1; x <= 1; ++x)
      for (long y = -1; y <= 1; ++y)
        for (long z = -1; z <= 1; ++z) {
          auto place = cubes_.find(cube + Key(x, y, z));
          if (place == cubes_.end()) continue;
          for (const Vector3d& other : place->second)
            if ((other - point).squaredNorm() < apart_ * apart_) return false;
        }
    cubes_[cube].push_back(point);
    return true;
  }

 private:
  using Key = Eigen::Matrix<long, 3, 1>;
  struct Before {
    bool operator()(const Key& a, const Key& b) const {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    }
  };

  double apart_;
  std::map<Key, std::vector<Vector3d>, Before> cubes_;
};

}  // namespace

std::vector<Vector3d> points_on_surface(const Mesh& mesh, std::span<const SurfacePart> parts,
                                        std::span<const Vector3d> inside, double reach) {
  std::vector<Vector3d> found;
  Spaced spaced(0.5 * reach);
  for (const SurfacePart& part : parts) {
    const Mesh patch = clipped(mesh, part);
    if (patch.triangles.empty()) continue;
    const MeshTree tree(patch);
    std::vector<std::optional<Vector3d>> nearest(inside.size());
    tbb::parallel_for(std::size_t{0}, inside.size(), [&](std::size_t i) {
      if (!holds(part, inside[i])) nearest[i] = tree.closest(inside[i], reach);
    });
    for (const auto& place : nearest) {
      if (!place) continue;
      // Rounding must not put it outside the box that it was clipped to.
      const Vector3d point = place->cwiseMax(part.min).cwiseMin(part.max);
      if (holds(part, point) && spaced.keep(point)) found.push_back(point);
    }
  }
  return found;
}

}  // namespace deforma
