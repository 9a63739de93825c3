#include "pipeline/overlap.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "sim/obstacle.hpp"

namespace deforma {

namespace {

using Bounds = Eigen::AlignedBox3d;

/// Depths below this share of a body's size are how a body rests on something.
constexpr double noticeable = 0.01;

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (const Vec3& point : mesh.points) bounds.extend(point);
  return bounds;
}

void warn_of_bodies(const State& state, std::span<const Mesh> meshes, const std::vector<Bounds>& bounds,
                    std::vector<std::string>& warnings) {
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
      if (count > 0)
        warnings.push_back(fmt::format("{}: begins with {} of its {} particles inside {}",
                                       state.bodies[a].name, count, own.size(), state.bodies[b].name));
    }
  }
}

void warn_of_obstacles(const State& state, const std::vector<Bounds>& bounds,
                       std::vector<std::string>& warnings) {
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
    for (std::size_t b = 0; b < deepest.size(); ++b)
      if (deepest[b] > noticeable * bounds[b].sizes().maxCoeff())
        warnings.push_back(fmt::format("{}: begins {:.3g} m deep inside the solid part of {}",
                                       state.bodies[b].name, deepest[b], obstacle.name));
  }
}

}  // namespace

void warn_of_overlaps(const State& state, std::span<const Mesh> meshes, std::vector<std::string>& warnings) {
  std::vector<Bounds> bounds;
  for (const Mesh& mesh : meshes) bounds.push_back(bounds_of(mesh));
  warn_of_bodies(state, meshes, bounds, warnings);
  warn_of_obstacles(state, bounds, warnings);
}

}  // namespace deforma
