#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/camera.hpp"
#include "render/color_map.hpp"
#include "render/context.hpp"
#include "render/image.hpp"
#include "render/quality.hpp"

namespace deforma {

/// How something looks. Colours are sRGB in [0, 1].
struct Look {
  Eigen::Vector3f color = {0.80f, 0.35f, 0.20f};
  float opacity = 1.0f;    ///< below 1: drawn after everything opaque, back faces first
  float roughness = 0.5f;  ///< 0 mirror-like highlight, 1 matte
  bool flat = false;       ///< one normal per triangle instead of smooth shading
  float metallic = 0.0f;   ///< 1: metal, which mirrors in its own colour; 0: anything else
  /// Colour of the triangles' edges, drawn over them when given; of meshes only.
  std::optional<Eigen::Vector3f> edges = std::nullopt;
};

/// One triangle surface in a frame.
struct DrawnMesh {
  std::span<const Eigen::Vector3d> points;   ///< [m]
  std::span<const Eigen::Vector3d> normals;  ///< unit; may be empty when look.flat
  std::span<const std::array<std::uint32_t, 3>> triangles;
  Look look;
  std::span<const float> values =
      {};  ///< one per point, in units of the colour scale, which gives the colour then; or empty
};

/// Particles of a frame, drawn as shaded spheres.
struct DrawnSpheres {
  std::span<const Eigen::Vector3d> centers;  ///< [m]
  double radius = 0.01;                      ///< [m]
  Look look;
  std::span<const float> values = {};  ///< one per sphere, as of a mesh; or empty
};

/// The floor: a large disc that fades into the background and takes the shadow.
struct DrawnGround {
  double height = 0.0;  ///< z [m]
  Eigen::Vector3f color = {0.78f, 0.78f, 0.78f};
};

struct Light {
  Eigen::Vector3d direction = {0.6, 0.45, -1.0};  ///< the way it shines
  Eigen::Vector3f color = {1.0f, 0.985f, 0.965f};
  float intensity = 2.7f;
  float ambient = 0.5f;   ///< of the sky
  float exposure = 0.0f;  ///< stops: each doubles all light, but not the background
};

struct FrameContent {
  std::vector<DrawnMesh> meshes;
  std::vector<DrawnSpheres> spheres;
  const DrawnGround* ground = nullptr;
  const ColorScale* color_scale = nullptr;  ///< needed where something has values
  Camera camera;
  Light light;
  Eigen::Vector3f background = {0.93f, 0.94f, 0.95f};
  /// Neither floor nor backdrop is seen, though the floor's light is; the picture has straight alpha.
  bool transparent = false;
};

struct RendererSettings {
  int width = 1280;
  int height = 720;
  Detail detail;
};

/// What drawing has cost so far: sums over frames [s], by the driver's clock. All but `frames` stay 0 where it has none.
struct DrawingCost {
  int frames = 0;
  double upload = 0.0;    ///< of the bodies, on the calling thread
  double shadow = 0.0;    ///< shadow map, and shadow and occlusion of the ground
  double shading = 0.0;   ///< everything that is seen
  double resolve = 0.0;   ///< samples of a pixel into one colour
  double readback = 0.0;  ///< of the picture into memory
};

/// Draws frames into memory. Use it from the thread that made it.
class Renderer {
 public:
  /// @throws std::invalid_argument for sizes that are not positive or above the driver's limit;
  ///         std::runtime_error when no context can be had (each attempt is listed) or a shader does not
  ///         compile.
  Renderer(const RendererSettings& settings, const ContextRequest& request = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  Image draw(const FrameContent& frame);

  const ContextFacts& facts() const;
  const DrawingCost& cost() const;
  /// Of the last frame.
  const Antialiasing& antialiasing() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace deforma
