#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/shape_registry.hpp"
#include "sim/curve.hpp"
#include "sim/effects/registry.hpp"
#include "sim/parameters.hpp"
#include "sim/solver.hpp"

namespace deforma {

struct OutputSpec {
  int width = 1280;
  int height = 720;
  std::string video = "mp4";  ///< container, or "none"
  // How the video is encoded, as in EncodingRequest; `load_scene` fills in what the encoder has.
  std::optional<std::string> codec, preset, pixel_format;
  std::optional<int> crf;
  bool transparent = false;          ///< straight alpha instead of floor and backdrop
  std::string view = "surface";      ///< or "particles", "both"
  std::string quality = "standard";  ///< or "draft", "final"
  std::optional<int> samples;        ///< multisampling; that of the quality when absent
  std::string color_by = "none";     ///< a field, whose values colour the bodies
  std::string color_map = "automatic";
  std::optional<std::array<double, 2>>
      color_range;        ///< [SI unit of the field]; found over the run when absent
  bool color_bar = true;  ///< drawn into the frames
};

struct SolverSpec {
  std::string integrator = "velocity_verlet";
  double step_fraction = 0.7;
  double max_step = 0.0;  ///< [s]; 0: none
  std::string kernel = "cubic_spline";
  std::string gradient = "quadratic";
  std::optional<int> neighbors;   ///< what suits the gradient, and no more than there are, when absent
  std::optional<double> support;  ///< what suits the gradient when absent
  bool portable = false;          ///< the same bits on any x86-64 processor
};

/// How a surface looks; colours are sRGB in [0, 1].
struct LookSpec {
  Vec3 color = {0.80, 0.35, 0.20};
  double opacity = 1.0;
  double roughness = 0.5;
  bool flat = false;
  double metallic = 0.0;
  std::optional<Vec3> edges = std::nullopt;  ///< colour of the triangles' edges; none are drawn when absent
};

/// One table of one effect.
struct SceneEffect {
  const EffectInfo* info;
  Parameters parameters;
  std::string where;  ///< file, line and key, for messages
};

/// A built-in shape with its sizes.
struct SceneShape {
  const ShapeInfo* info;
  Parameters parameters;
};

struct SceneBody {
  std::string name;
  std::optional<std::string> mesh;  ///< as written: found, but possibly an installed one
  std::filesystem::path mesh_file;  ///< where `mesh` was found
  std::optional<SceneShape> shape;  ///< exactly one of mesh and shape
  Vec3 position = Vec3::Zero();     ///< of the mesh's own origin [m]
  Vec3 rotation = Vec3::Zero();     ///< rotation vector [degrees]
  Vec3 scale = Vec3::Ones();
  std::optional<int> particles;   ///< exactly one of particles and spacing
  std::optional<double> spacing;  ///< [m]
  std::string sampling = "lattice";
  double jitter = 0.0;  ///< points are moved by up to so many spacings along each axis
  std::string mass_rule =
      "cell";  ///< what a particle's mass and volume are: its part of the body, an equal share, or the paper's rule
  int subdivide = 0;                     ///< times
  std::optional<int> surface_particles;  ///< subdivide until there are so many vertices
  double density = 1000.0;               ///< [kg/m^3]
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< about the centre of mass [rad/s]
  LookSpec look;
  bool visible = true;
  std::vector<SceneEffect> effects;       ///< its own tables, in the registry's order
  std::vector<std::string_view> without;  ///< effects refused with `false`: the world's do not apply
  std::string where;                      ///< file, line and key, for messages
  std::string mesh_where;                 ///< the same of its mesh or shape
};

struct SceneObstacle {
  std::string name;
  const ObstacleInfo* info = nullptr;
  Parameters parameters{std::span<const Setting>()};  ///< of its shape
  std::string mesh;                                   ///< file of a mesh obstacle, as written
  std::filesystem::path mesh_file;                    ///< where it was found
  Curve<Vec3> position = Vec3(0, 0, 0);               ///< [m]
  Curve<Vec3> rotation = Vec3(0, 0, 0);               ///< rotation vector [degrees]
  double friction = 0.0;
  bool visible = true;
  LookSpec look;
  std::string where;  ///< file, line and key, for messages
};

struct CameraSpec {
  std::optional<Curve<Vec3>> position;  ///< automatic framing when absent [m]
  std::optional<Curve<Vec3>> target;    ///< the middle of the scene when absent [m]
  Vec3 up = Vec3::UnitZ();
  double field_of_view = 30.0;  ///< vertical [degrees]
  std::string projection = "perspective";
  std::optional<double> height;  ///< of what an orthographic picture shows; all of the scene when absent [m]
  double orbit = 0.0;            ///< turn around the target, about `up` [degrees/s]
};

struct LightSpec {
  Vec3 direction = {0.6, 0.45, -1.0};  ///< the way it shines
  double intensity = 2.7;
  double ambient = 0.5;   ///< of the sky
  double exposure = 0.0;  ///< stops
};

struct GroundSpec {
  double height = 0.0;  ///< z [m]
  Vec3 color = {0.78, 0.78, 0.78};
  bool solid = true;
  double friction = 0.5;
  bool visible = true;
};

/// All that a scene file says, with every default filled in.
struct Scene {
  std::filesystem::path file;  ///< that it was read from
  std::string name;
  double duration = 0.0;  ///< [s]
  double fps = 25.0;
  OutputSpec output;
  SolverSpec solver;
  std::vector<SceneEffect> world;  ///< for every body that does not have or refuse its own
  std::vector<SceneBody> bodies;
  std::vector<SceneObstacle> obstacles;
  CameraSpec camera;
  LightSpec light;
  std::optional<GroundSpec> ground;

  int frames() const;  ///< round(duration * fps), at least 1
};

/// A key of the scene given on the command line instead.
struct Override {
  std::string key;     ///< a path such as body.0.elastic.young or body.duck.density
  std::string value;   ///< TOML; what is none counts as text
  std::string origin;  ///< the option as typed, for messages
};

/// Splits KEY=VALUE. @throws UserError without '='
Override parse_override(const std::string& argument);

/// Reads a scene file.
/// @param file as found by `find_scene`
/// @throws UserError with file, line, key, what was found, what is allowed and the nearest valid name.
Scene load_scene(const std::filesystem::path& file, const std::vector<Override>& overrides = {});

/// The scene as TOML that `load_scene` reads back to the same scene, from any folder.
std::string scene_to_toml(const Scene& scene);

/// The same as JSON.
std::string scene_to_json(const Scene& scene);

}  // namespace deforma
