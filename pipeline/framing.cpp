#include "pipeline/framing.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <numbers>

#include "pipeline/obstacle_mesh.hpp"
#include "pipeline/user_error.hpp"

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

/// All the room that a box takes while it turns about the upright line through its middle.
Bounds turned(const Bounds& bounds) {
  double radius = 0.5 * bounds.sizes().head<2>().norm();
  Vec3 center = bounds.center(), reach(radius, radius, 0.5 * bounds.sizes().z());
  return {Vec3(center - reach), Vec3(center + reach)};
}

void check_view(const Scene& scene, double time) {
  Camera camera = camera_at(scene.camera, time);
  Vec3 view = camera.target - camera.eye;
  if (view.cross(camera.up).norm() > 1e-9 * view.norm() * camera.up.norm()) return;
  throw UserError(fmt::format(
      "{}: camera: looks at {} s from [{}, {}, {}] to [{}, {}, {}] along its up direction [{}, {}, {}]",
      scene.file.string(), time, camera.eye.x(), camera.eye.y(), camera.eye.z(), camera.target.x(),
      camera.target.y(), camera.target.z(), camera.up.x(), camera.up.y(), camera.up.z()));
}

}  // namespace

void frame_scene(Scene& scene, const State& state) {
  CameraSpec& spec = scene.camera;
  double aspect = static_cast<double>(scene.output.width) / scene.output.height;
  bool parallel = spec.projection == "orthographic";
  Bounds bounds = scene_bounds(scene, state);
  if (spec.orbit != 0.0) bounds = turned(bounds);
  if (!spec.position || !spec.target) {
    Vec3 direction = Vec3(0.55, -1.0, 0.42);
    if (spec.position) direction = spec.position->at(0.0) - bounds.center();
    Camera camera = frame_box(bounds.min(), bounds.max(), aspect, direction, spec.field_of_view);
    Vec3 to_eye = camera.eye - camera.target;
    if (!spec.target) spec.target = parallel ? Vec3(bounds.center()) : camera.target;
    if (!spec.position) spec.position = Vec3(spec.target->at(0.0) + to_eye);
  }
  for (int frame = 1; frame <= scene.frames(); ++frame) check_view(scene, (frame - 1) / scene.fps);
  if (parallel && !spec.height)
    spec.height = frame_height(camera_at(spec, 0.0), bounds.min(), bounds.max(), aspect);
}

Camera camera_at(const CameraSpec& spec, double time) {
  Camera camera;
  camera.target = spec.target->at(time);
  Vec3 to_eye = spec.position->at(time) - camera.target;
  if (spec.orbit != 0.0) {
    double angle = spec.orbit * time * std::numbers::pi / 180.0;
    to_eye = Eigen::AngleAxisd(angle, spec.up.normalized()) * to_eye;
  }
  camera.eye = camera.target + to_eye;
  camera.up = spec.up;
  camera.field_of_view = spec.field_of_view;
  camera.height = spec.height.value_or(0.0);
  return camera;
}

}  // namespace deforma
