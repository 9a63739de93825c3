#pragma once

#include <string>

#include "render/quality.hpp"

namespace deforma {

/// The places that all programs share.
struct ShaderPlaces {
  static constexpr unsigned frame_block = 0;
  static constexpr int shadow_map = 0;     ///< compared by the hardware
  static constexpr int shadow_depths = 1;  ///< the same texture, its plain depths
  static constexpr int underside = 2;      ///< heights of what hangs above the ground
  static constexpr int ground_light = 3;   ///< baked: share of the key light and of the sky on the ground
  static constexpr int ground_key = 4;     ///< on the way to it: the key light's share, noisy
  static constexpr int ground_sky = 5;     ///< and the sky's, coarse
  static constexpr int color_map = 8;      ///< base colours of values
  static constexpr unsigned position = 0;
  static constexpr unsigned normal = 1;
  static constexpr unsigned value = 2;  ///< place in the colour map
};

/// GLSL sources of one program.
struct ShaderSource {
  std::string vertex;
  std::string fragment;
};

/// Most multisampling samples that a sphere's outline is resolved for.
constexpr int max_samples = 8;

/// @param sample_mask whether the driver has GLSL 4.00, whose fragments choose their samples
/// @param detail how many taps shadows take
struct ShaderSources {
  ShaderSources(bool sample_mask, const Detail& detail);
  ShaderSource mesh;          ///< lit triangles
  ShaderSource glass;         ///< translucent triangles
  ShaderSource glass_edge;    ///< their rims and creases, as lines
  ShaderSource sphere;        ///< lit spheres, one quad each
  ShaderSource wire;          ///< edges of triangles, in one colour whatever the light
  ShaderSource ground;        ///< the floor
  ShaderSource backdrop;      ///< what lies behind everything
  ShaderSource mesh_depth;    ///< triangles into a depth map by a parallel projection
  ShaderSource sphere_depth;  ///< spheres into a depth map by a parallel projection
  ShaderSource ground_key;    ///< share of the key light that reaches the floor, once per texel
  ShaderSource ground_sky;    ///< share of the sky that reaches the floor, once per coarse texel
  ShaderSource ground_light;  ///< both, smoothed
};

}  // namespace deforma
