#include "pipeline/drawing.hpp"

#include "pipeline/framing.hpp"
#include "pipeline/obstacle_mesh.hpp"
#include "sim/fields.hpp"

namespace deforma {

namespace {

/// How much of the surface is left to see when the particles inside it are shown too.
constexpr float veil = 0.25f;
/// A particle's ball is a little smaller than the cell it stands for.
constexpr double ball_radius = 0.42;

Look look_of(const LookSpec& spec) {
  Look look{spec.color.cast<float>(),           static_cast<float>(spec.opacity),
            static_cast<float>(spec.roughness), spec.flat,
            static_cast<float>(spec.metallic),  {}};
  if (spec.edges) look.edges = spec.edges->cast<float>();
  return look;
}

bool draws_surface(const Scene& scene) { return scene.output.view != "particles"; }
bool draws_particles(const Scene& scene) { return scene.output.view != "surface"; }

}  // namespace

RendererSettings renderer_settings(const Scene& scene) {
  RendererSettings settings;
  settings.width = scene.output.width;
  settings.height = scene.output.height;
  settings.detail = detail_of(scene.output.quality);
  if (scene.output.samples) {
    settings.detail.antialiasing = {*scene.output.samples, 1};
    settings.detail.fits_machine = false;
  }
  return settings;
}

Snapshot take_snapshot(const Scene& scene, const Solver& solver, int frame) {
  Snapshot snapshot{frame, (frame - 1) / scene.fps, {}, {}, {}, {}};
  const State& state = solver.state();
  if (draws_surface(scene)) {
    snapshot.points.resize(state.surface.size());
    solver.deform(snapshot.points);
  }
  if (draws_particles(scene)) {
    snapshot.particles.reserve(state.size());
    for (std::size_t i = 0; i < state.size(); ++i) snapshot.particles.push_back(state.particles.position(i));
  }
  if (scene.output.color_by != "none") {
    snapshot.point_values.resize(snapshot.points.size());
    snapshot.particle_values.resize(snapshot.particles.size());
    evaluate_field(find_field(scene.output.color_by), state, solver.effects(), snapshot.particle_values,
                   snapshot.point_values);
  }
  return snapshot;
}

Drawing::Drawing(const Scene& scene, const State& state) : scene_(scene), state_(state) {
  light_.direction = scene.light.direction;
  light_.intensity = static_cast<float>(scene.light.intensity);
  light_.ambient = static_cast<float>(scene.light.ambient);
  light_.exposure = static_cast<float>(scene.light.exposure);
  if (scene.ground) ground_ = {scene.ground->height, scene.ground->color.cast<float>()};

  for (const Body& body : state.bodies) {
    std::vector<Triangle>& own = triangles_.emplace_back();
    for (Index t = body.triangles.begin; t < body.triangles.end; ++t) {
      Triangle triangle = state.surface.triangles[t];
      for (Index& vertex : triangle) vertex -= body.vertices.begin;
      own.push_back(triangle);
    }
  }

  double plane_size = 0.0;
  for (int frame = 1; frame <= scene.frames(); ++frame) {
    const Camera camera = camera_at(scene.camera, (frame - 1) / scene.fps);
    plane_size = std::max(plane_size, 2.0 * (camera.eye - camera.target).norm());
  }
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    if (!scene.obstacles[o].visible) continue;
    Prop prop{&state.obstacles[o], look_of(scene.obstacles[o].look), {}, {}, {}, {}, {}};
    Mesh mesh = make_obstacle_mesh(prop.obstacle->shape, plane_size);
    prop.points = std::move(mesh.points);
    prop.triangles = std::move(mesh.triangles);
    prop.normals.resize(prop.points.size());
    vertex_normals(prop.points, prop.triangles, prop.normals);
    prop.placed_points = prop.points;
    prop.placed_normals = prop.normals;
    place(prop, 0.0);
    props_.push_back(std::move(prop));
  }
}

void Drawing::place(Prop& prop, double time) const {
  Pose pose = prop.obstacle->pose_at(time);
  for (std::size_t v = 0; v < prop.points.size(); ++v) {
    prop.placed_points[v] = pose.position + pose.rotation * prop.points[v];
    prop.placed_normals[v] = pose.rotation * prop.normals[v];
  }
}

FrameContent Drawing::content(const Snapshot& snapshot) {
  FrameContent frame;
  frame.camera = camera_at(scene_.camera, snapshot.time);
  frame.light = light_;
  if (scene_.ground && scene_.ground->visible) frame.ground = &ground_;
  frame.transparent = scene_.output.transparent;
  if (color_scale_.map) frame.color_scale = &color_scale_;
  const auto values = [](const std::vector<float>& all, const Range& part) {
    return all.empty() ? std::span<const float>() : std::span(all).subspan(part.begin, part.size());
  };
  if (!snapshot.points.empty()) {
    normals_.resize(snapshot.points.size());
    vertex_normals(snapshot.points, state_.surface.triangles, normals_);
  }
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (!scene_.bodies[b].visible) continue;
    const Body& body = state_.bodies[b];
    Look look = look_of(scene_.bodies[b].look);
    if (!snapshot.particles.empty())
      frame.spheres.push_back(
          {std::span(snapshot.particles).subspan(body.particles.begin, body.particles.size()),
           ball_radius * body.spacing, look, values(snapshot.particle_values, body.particles)});
    if (snapshot.points.empty()) continue;
    if (!snapshot.particles.empty()) look.opacity *= veil;
    frame.meshes.push_back({std::span(snapshot.points).subspan(body.vertices.begin, body.vertices.size()),
                            std::span(normals_).subspan(body.vertices.begin, body.vertices.size()),
                            triangles_[b], look, values(snapshot.point_values, body.vertices)});
  }
  for (Prop& prop : props_) {
    if (prop.obstacle->position.varies() || prop.obstacle->rotation.varies()) place(prop, snapshot.time);
    frame.meshes.push_back({prop.placed_points, prop.placed_normals, prop.triangles, prop.look});
  }
  return frame;
}

}  // namespace deforma
