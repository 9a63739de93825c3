#include "sim/near_surfaces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "sim/parallel.hpp"
#include "sim/triangle_tree.hpp"

namespace deforma {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Bounds {
  Vec3 low = Vec3::Constant(infinity), high = Vec3::Constant(-infinity);

  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double distance(const Vec3& p) const { return (low - p).cwiseMax(p - high).cwiseMax(0.0).norm(); }
};

Vec3 area_vector(std::span<const Vec3> points, const Triangle& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

double distance_to(const Vec3& p, std::span<const Vec3> points, const Triangle& t) {
  const Vec3 w = closest_barycentric(p, points[t[0]], points[t[1]], points[t[2]]);
  return (p - w[0] * points[t[0]] - w[1] * points[t[1]] - w[2] * points[t[2]]).norm();
}

// Drops the triangles of a vertex's own body that are its neighbours, or that it stands behind.
void keep_facing(const Surface& surface, std::span<const Vec3> points, Index s, double exclusion,
                 bool touching, std::vector<Index>& triangles) {
  std::erase_if(triangles, [&](Index k) {
    const Triangle& t = surface.triangles[k];
    if (distance_to(surface.rest[s], surface.rest, t) < exclusion) return true;
    return !touching && (points[s] - points[t[0]]).dot(area_vector(points, t)) < 0.0;
  });
}

}  // namespace

double find_near_surfaces(const State& state, std::span<const Vec3> points, Index a, Index b,
                          const NearSettings& settings, const std::function<bool(Index vertex)>& touching,
                          std::vector<NearSurface>& near) {
  const Surface& surface = state.surface;
  const Range vertices = state.bodies[a].vertices, triangles = state.bodies[b].triangles;
  // Both may move by the margin, so any distance may change by twice that; a triangle not closest by four
  // times can not become the closest.
  const double reach = settings.depth + 2.0 * settings.margin;
  Bounds bounds;
  for (Index k = triangles.begin; k < triangles.end; ++k)
    for (Index corner : surface.triangles[k]) bounds.add(points[corner]);
  std::vector<Index> close;
  double far = infinity;
  for (Index s = vertices.begin; s < vertices.end; ++s) {
    const double distance = bounds.distance(points[s]);
    if (distance <= reach)
      close.push_back(s);
    else
      far = std::min(far, 0.5 * (distance - settings.depth));
  }
  if (close.empty()) return far;

  const TriangleTree tree(points, std::span(surface.triangles).subspan(triangles.begin, triangles.size()));
  std::vector<NearSurface> found(close.size());
  parallel_for_each(
      close.size(),
      [&](std::size_t k) {
        const Index s = close[k];
        found[k] = {s, b, {}};
        double distance = 0.0;  // within one body the closest is not known before the neighbours are dropped
        if (a != b) {
          distance = tree.closest(points[s], reach).distance;
          if (distance > reach) return;
        }
        tree.within(points[s], a == b ? reach : distance + 4.0 * settings.margin, found[k].triangles);
        for (Index& t : found[k].triangles) t += triangles.begin;
        if (a == b) keep_facing(surface, points, s, settings.exclusion, touching(s), found[k].triangles);
      },
      64);
  for (NearSurface& item : found)
    if (!item.triangles.empty()) near.push_back(std::move(item));
  return std::min(far, settings.margin);
}

std::optional<Penetration> find_penetration(const Surface& surface, const NearSurface& near, double depth,
                                            double reach) {
  const std::vector<Vec3>& x = surface.position;
  const Vec3& p = x[near.vertex];
  struct Candidate {
    Index triangle;
    Vec3 barycentric, point;
    double distance;
  };
  Candidate best{0, Vec3::Zero(), Vec3::Zero(), infinity};
  thread_local std::vector<Candidate> all;
  all.clear();
  for (Index k : near.triangles) {
    const Triangle& t = surface.triangles[k];
    const Vec3 w = closest_barycentric(p, x[t[0]], x[t[1]], x[t[2]]);
    const Vec3 q = w[0] * x[t[0]] + w[1] * x[t[1]] + w[2] * x[t[2]];
    all.push_back({k, w, q, (p - q).norm()});
    if (all.back().distance < best.distance) best = all.back();
  }
  if (!(best.distance < std::max(depth, reach))) return std::nullopt;
  Vec3 normal = Vec3::Zero();
  for (const Candidate& c : all) {
    if ((c.point - best.point).norm() > 1e-6 * best.distance) continue;
    const Triangle& t = surface.triangles[c.triangle];
    const Vec3 area = area_vector(x, t);
    if (!(area.norm() > 0.0)) continue;
    double angle = 1.0;  // the same on both sides of an edge; a corner weighs each triangle by its angle
    for (int k = 0; k < 3; ++k)
      if (c.barycentric[k] == 1.0) angle = corner_angle(x[t[k]], x[t[(k + 1) % 3]], x[t[(k + 2) % 3]]);
    normal += angle * area.normalized();
  }
  const Vec3 apart = p - best.point;
  const double side = apart.dot(normal) < 0.0 ? -1.0 : 1.0;
  const double inside = -side * best.distance;
  if (inside > depth || inside <= -reach) return std::nullopt;
  if (best.distance > 0.0)
    normal = side / best.distance * apart;
  else
    normal.normalize();
  return Penetration{inside, normal, best.triangle, best.barycentric};
}

}  // namespace deforma
