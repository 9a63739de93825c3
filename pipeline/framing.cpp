#include "pipeline/framing.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>

#include "pipeline/obstacle_mesh.hpp"
#include "pipeline/user_error.hpp"
#include "render/camera.hpp"

namespace deforma {

namespace {

using Bounds = Eigen::AlignedBox3d;

void extend_by_obstacle(Bounds& bounds, const Obstacle& obstacle) {
  if (std::holds_alternative<PlaneShape>(obstacle.shape)) return;
  Mesh mesh = make_obstacle_mesh(obstacle.shape, 0.0);
  auto extend = [&](double time) {
    Pose pose = obstacle.pose_at(time);
    for (const Vec3& point : mesh.points) bounds.extend(pose.position + pose.rotation * point);
  };
  for (const auto& [time, position] : obstacle.position.keys()) extend(time);
  for (const auto& [time, rotation] : obstacle.rotation.keys()) extend(time);
}

/// Where a body that falls freely comes down, with room to bounce and topple to any side.
Bounds landing_place(const Bounds& start, double ground) {
  double room = 0.3 * start.sizes().maxCoeff();
  Vec3 low = start.min() - Vec3(room, room, 0.0), high = start.max() + Vec3(room, room, 0.0);
  return {Vec3(low.x(), low.y(), ground), Vec3(high.x(), high.y(), ground + 0.5 * start.sizes().z())};
}

Bounds scene_bounds(const Scene& scene, const State& state) {
  Bounds bounds;
  for (std::size_t s = 0; s < state.surface.size(); ++s)
    if (scene.bodies[state.surface.body[s]].visible) bounds.extend(state.surface.rest[s]);
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o)
    if (scene.obstacles[o].visible) extend_by_obstacle(bounds, state.obstacles[o]);
  if (bounds.isEmpty()) bounds = Bounds(Vec3::Constant(-1.0), Vec3::Constant(1.0));
  if (scene.ground && scene.obstacles.empty()) bounds.extend(landing_place(bounds, scene.ground->height));
  if (scene.ground) bounds.extend(Vec3(bounds.center().x(), bounds.center().y(), scene.ground->height));
  return bounds;
}

}  // namespace

void frame_scene(Scene& scene, const State& state) {
  CameraSpec& spec = scene.camera;
  if (!spec.position || !spec.target) {
    Bounds bounds = scene_bounds(scene, state);
    double aspect = static_cast<double>(scene.output.width) / scene.output.height;
    Vec3 direction = Vec3(0.55, -1.0, 0.42);
    if (spec.position) direction = *spec.position - bounds.center();
    Camera camera = frame_box(bounds.min(), bounds.max(), aspect, direction, spec.field_of_view);
    Vec3 to_eye = camera.eye - camera.target;
    if (!spec.target) spec.target = camera.target;
    if (!spec.position) spec.position = *spec.target + to_eye;
  }
  Vec3 view = *spec.target - *spec.position;
  if (view.cross(spec.up).norm() <= 1e-9 * view.norm() * spec.up.norm())
    throw UserError(fmt::format(
        "{}: camera: looks from [{}, {}, {}] to [{}, {}, {}] along its up direction [{}, {}, {}]",
        scene.file.string(), spec.position->x(), spec.position->y(), spec.position->z(), spec.target->x(),
        spec.target->y(), spec.target->z(), spec.up.x(), spec.up.y(), spec.up.z()));
}

}  // namespace deforma
