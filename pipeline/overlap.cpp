#include "pipeline/overlap.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "pipeline/user_error.hpp"
#include "sim/obstacle.hpp"

namespace deforma {

namespace {

using Bounds = Eigen::AlignedBox3d;

/// Depths below this share of a body's size are how a body rests on something.
constexpr double noticeable = 0.01;
/// Depths above this share of a body's spacing are more than contact can ease out.
constexpr double deep = 0.25;

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (const Vec3& point : mesh.points) bounds.extend(point);
  return bounds;
}

void check_bodies(const State& state, std::span<const Mesh> meshes, const std::vector<Bounds>& bounds,
                  std::span<const std::string> touching, std::vector<std::string>& warnings) {
  for (std::size_t b = 0; b < meshes.size(); ++b) {
    std::vector<std::size_t> near;
    for (std::size_t a = 0; a < meshes.size(); ++a)
      if (a != b && bounds[a].intersects(bounds[b])) near.push_back(a);
    if (near.empty()) continue;
    ObstacleField inside({state.bodies[b].name, MeshShape{meshes[b].points, meshes[b].triangles}});
    for (std::size_t a : near) {
      std::size_t count = 0;
      const Range& own = state.bodies[a].particles;
      std::vector<Touch> touches;
      for (Index i = own.begin; i < own.end; ++i) {
        touches.clear();
        if (bounds[b].contains(state.particles.rest[i])) inside.find(state.particles.rest[i], touches);
        if (!touches.empty()) ++count;
      }
      if (count == 0) continue;
      std::string found = fmt::format("'{}' begins with {} of its {} particles inside '{}'",
                                      state.bodies[a].name, count, own.size(), state.bodies[b].name);
      if (!touching[a].empty() && !touching[b].empty())
        throw UserError(fmt::format("{}: {}: contact would throw them apart; move one", touching[a], found));
      warnings.push_back(found);
    }
  }
}

void check_obstacles(const State& state, const std::vector<Bounds>& bounds,
                     std::span<const std::string> touching, std::vector<std::string>& warnings) {
  for (const Obstacle& obstacle : state.obstacles) {
    ObstacleField solid(obstacle);
    Pose pose = obstacle.pose_at(0.0);
    std::vector<double> deepest(state.bodies.size(), 0.0);
    std::vector<Touch> touches;
    for (std::size_t s = 0; s < state.surface.size(); ++s) {
      touches.clear();
      solid.find(pose.rotation.transpose() * (state.surface.rest[s] - pose.position), touches);
      for (const Touch& touch : touches) {
        double& depth = deepest[state.surface.body[s]];
        depth = std::max(depth, touch.depth);
      }
    }
    for (std::size_t b = 0; b < deepest.size(); ++b) {
      std::string found = fmt::format("'{}' begins {:.3g} m deep inside the solid part of '{}'",
                                      state.bodies[b].name, deepest[b], obstacle.name);
      if (!touching[b].empty() && deepest[b] > deep * state.bodies[b].spacing)
        throw UserError(
            fmt::format("{}: {}: contact would throw it out; move it ({:.3g} m, a quarter of its "
                        "particles' spacing, is allowed; containers are solid all around, and open ones "
                        "beside their mouth too)",
                        touching[b], found, deep * state.bodies[b].spacing));
      if (deepest[b] > noticeable * bounds[b].sizes().maxCoeff()) warnings.push_back(found);
    }
  }
}

}  // namespace

void check_overlaps(const State& state, std::span<const Mesh> meshes, std::span<const std::string> touching,
                    std::vector<std::string>& warnings) {
  std::vector<Bounds> bounds;
  for (const Mesh& mesh : meshes) bounds.push_back(bounds_of(mesh));
  check_bodies(state, meshes, bounds, touching, warnings);
  check_obstacles(state, bounds, touching, warnings);
}

}  // namespace deforma
