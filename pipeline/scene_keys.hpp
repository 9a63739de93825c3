#pragma once

#include <array>
#include <string_view>

#include "pipeline/scene.hpp"
#include "render/color_map.hpp"
#include "render/quality.hpp"
#include "sim/fields.hpp"
#include "sim/kernel.hpp"
#include "sim/moving_least_squares.hpp"

// The keys of a scene stand here once: each `describe` is followed by the reader and by the writer (`Io`),
// which have the same methods. Effects, shapes and obstacles have registries of their own.
namespace deforma {

inline constexpr std::array<std::string_view, 6> video_choices = {"mp4", "mkv", "mov", "webm", "gif", "none"};
inline constexpr std::array<std::string_view, 3> view_choices = {"surface", "particles", "both"};
inline constexpr std::array<std::string_view, 2> projection_choices = {"perspective", "orthographic"};
inline constexpr std::array<std::string_view, 2> integrator_choices = {"symplectic_euler", "velocity_verlet"};
inline constexpr std::array<std::string_view, 3> sampling_choices = {"lattice", "body_centered",
                                                                     "blue_noise"};

inline constexpr std::array<std::string_view, 3> mass_rule_choices = {"cell", "equal", "paper"};

/// The names of a registry after the word for none of them, or for any.
inline std::vector<std::string_view> choices_after(std::string_view first,
                                                   std::span<const std::string_view> names) {
  std::vector<std::string_view> choices = {first};
  choices.insert(choices.end(), names.begin(), names.end());
  return choices;
}

template <typename Io>
void describe(Io& io, OutputSpec& output) {
  io.size("size", output.width, output.height);
  io.choice("video", output.video, video_choices);
  io.value("codec", output.codec);
  io.value("preset", output.preset);
  io.value("pix_fmt", output.pixel_format);
  io.value("crf", output.crf, 0, 63);
  io.value("transparent", output.transparent);
  io.choice("view", output.view, view_choices);
  io.choice("quality", output.quality, quality_names());
  io.value("samples", output.samples, 1, 32);
  io.choice("color_by", output.color_by, choices_after("none", field_names()));
  io.choice("color_map", output.color_map, choices_after("automatic", color_map_names()));
  io.range("color_range", output.color_range);
  io.value("color_bar", output.color_bar);
}

template <typename Io>
void describe(Io& io, SolverSpec& solver) {
  io.choice("integrator", solver.integrator, integrator_choices);
  io.value("step_fraction", solver.step_fraction, Interval{0.0, 1.0, true, false});
  io.value("max_step", solver.max_step, Interval::non_negative());
  io.choice("kernel", solver.kernel, kernel_names());
  io.choice("gradient", solver.gradient, gradient_names());
  io.value("neighbors", solver.neighbors, 3, 200);
  io.value("support", solver.support, Interval{0.5, 5.0, false, false});
  io.value("portable", solver.portable);
}

template <typename Io>
void describe(Io& io, LookSpec& look) {
  io.color("color", look.color);
  io.value("opacity", look.opacity, Interval::closed(0.0, 1.0));
  io.value("roughness", look.roughness, Interval::closed(0.0, 1.0));
  io.value("metallic", look.metallic, Interval::closed(0.0, 1.0));
  io.value("flat", look.flat);
  io.color_or_flag("edges", look.edges, Vec3(0.10, 0.12, 0.14));
}

template <typename Io>
void describe(Io& io, SceneBody& body) {
  io.value("name", body.name);
  io.value("position", body.position);
  io.value("rotation", body.rotation);
  io.scale("scale", body.scale);
  io.value("particles", body.particles, 1, 2000000000);
  io.value("spacing", body.spacing, Interval::positive());
  io.choice("sampling", body.sampling, sampling_choices);
  io.value("jitter", body.jitter, Interval{0.0, 0.5, false, true});
  io.choice("mass_rule", body.mass_rule, mass_rule_choices);
  io.value("subdivide", body.subdivide, 0, 6);
  io.value("surface_particles", body.surface_particles, 1, 10000000);
  io.value("density", body.density, Interval::positive());
  io.value("velocity", body.velocity);
  io.value("angular_velocity", body.angular_velocity);
  io.value("visible", body.visible);
  io.table("look", [&](Io& inner) { describe(inner, body.look); });
}

template <typename Io>
void describe(Io& io, SceneObstacle& obstacle) {
  io.value("name", obstacle.name);
  io.value("position", obstacle.position);
  io.value("rotation", obstacle.rotation);
  io.value("friction", obstacle.friction, Interval::non_negative());
  io.value("visible", obstacle.visible);
  io.table("look", [&](Io& inner) { describe(inner, obstacle.look); });
}

template <typename Io>
void describe(Io& io, CameraSpec& camera) {
  io.value("position", camera.position);
  io.value("target", camera.target);
  io.value("up", camera.up);
  io.value("field_of_view", camera.field_of_view, Interval::open(1.0, 170.0));
  io.choice("projection", camera.projection, projection_choices);
  io.value("height", camera.height, Interval::positive());
  io.value("orbit", camera.orbit);
}

template <typename Io>
void describe(Io& io, LightSpec& light) {
  io.value("direction", light.direction);
  io.value("intensity", light.intensity, Interval::non_negative());
  io.value("ambient", light.ambient, Interval::non_negative());
  io.value("exposure", light.exposure, Interval::closed(-10.0, 10.0));
}

template <typename Io>
void describe(Io& io, GroundSpec& ground) {
  io.value("height", ground.height);
  io.color("color", ground.color);
  io.value("solid", ground.solid);
  io.value("friction", ground.friction, Interval::non_negative());
  io.value("visible", ground.visible);
}

template <typename Io>
void describe(Io& io, Scene& scene) {
  io.value("name", scene.name);
  io.require("duration", "how long it plays, s");
  io.value("duration", scene.duration, Interval::positive());
  io.value("fps", scene.fps, Interval{0.0, 1000.0, true, false});
  io.table("output", [&](Io& inner) { describe(inner, scene.output); });
  io.table("solver", [&](Io& inner) { describe(inner, scene.solver); });
  io.table("camera", [&](Io& inner) { describe(inner, scene.camera); });
  io.table("light", [&](Io& inner) { describe(inner, scene.light); });
}

}  // namespace deforma
