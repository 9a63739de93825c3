#pragma once

#include <vector>

#include "pipeline/scene.hpp"
#include "render/renderer.hpp"
#include "sim/solver.hpp"

namespace deforma {

/// What one frame shows, copied out of the simulation so that it can go on.
struct Snapshot {
  int frame = 1;                ///< counted from 1
  double time = 0.0;            ///< [s]
  std::vector<Vec3> points;     ///< of the whole surface, when drawn [m]
  std::vector<Vec3> particles;  ///< when drawn [m]
  // Of the field that colours them, in its unit; empty without one.
  std::vector<float> point_values = {};
  std::vector<float> particle_values = {};
};

/// Copies the state as far as the scene's view needs it.
Snapshot take_snapshot(const Scene& scene, const Solver& solver, int frame);

/// The renderer that a scene asks for: size, quality, antialiasing.
RendererSettings renderer_settings(const Scene& scene);

/// Turns snapshots into what the renderer draws.
class Drawing {
 public:
  /// @param scene with its camera filled in; it and the state must outlive the drawing, of which only what
  /// never
  ///        changes is used: bodies, triangles, obstacles
  Drawing(const Scene& scene, const State& state);

  /// Colours all bodies by the values in the snapshots; to be called before the first `content`.
  void color_by(const ColorScale& scale) { color_scale_ = scale; }

  /// The content refers to the snapshot and to this object and is valid until the next call.
  FrameContent content(const Snapshot& snapshot);

 private:
  /// An obstacle's surface, at rest in its own frame and where it is now.
  struct Prop {
    const Obstacle* obstacle;
    Look look;
    std::vector<Vec3> points, normals;
    std::vector<Vec3> placed_points, placed_normals;
    std::vector<Triangle> triangles;
  };
  void place(Prop& prop, double time) const;

  const Scene& scene_;
  const State& state_;
  std::vector<std::vector<Triangle>> triangles_;  ///< per body, counted from its own first vertex
  std::vector<Vec3> normals_;
  std::vector<Prop> props_;
  DrawnGround ground_;
  Light light_;
  ColorScale color_scale_;  ///< without a map: by their looks
};

}  // namespace deforma
