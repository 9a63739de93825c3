#pragma once

#include "render/frame_uniforms.hpp"
#include "render/geometry.hpp"
#include "render/gl.hpp"
#include "render/quality.hpp"
#include "render/scene_fit.hpp"

namespace deforma {

/// Finds once per frame where light is missing: a shadow map of the key light, and for the ground, which
/// covers most of a picture, a texture with the share of the light and of the sky that reaches it.
class LightPass {
 public:
  /// @param detail how large the maps are; the shadow map's size above 0
  LightPass(const ShaderSources& sources, const Detail& detail);

  /// Writes the parts of `uniforms` that tell the other shaders how to read the maps, and says whether there
  /// is anything that throws a shadow.
  bool fit(const SceneBounds& bounds, const Eigen::Vector3d& to_light, FrameUniforms& uniforms);

  /// Draws the maps. The uniform block must be bound with what `fit` has written.
  void draw(const Geometry& geometry);

  /// Binds the maps to their places.
  void bind() const;

 private:
  void draw_depths(const Geometry& geometry, const gl::Framebuffer& target, int size,
                   const Eigen::Matrix4f& projection, const Eigen::Matrix3f& axes);
  void draw_texels(const gl::Program& program, const gl::Framebuffer& target, int size);

  gl::Program mesh_depth_;
  gl::Program sphere_depth_;
  gl::Program ground_key_program_;
  gl::Program ground_sky_program_;
  gl::Program ground_light_program_;
  gl::Texture shadow_map_;
  gl::Texture underside_;
  gl::Texture ground_key_;
  gl::Texture ground_sky_;
  gl::Texture ground_light_;
  gl::Sampler compare_;
  gl::Sampler plain_;
  gl::Framebuffer shadow_target_;
  gl::Framebuffer underside_target_;
  gl::Framebuffer key_target_;
  gl::Framebuffer sky_target_;
  gl::Framebuffer ground_target_;
  gl::VertexArray empty_;
  int shadow_size_, ground_size_, sky_size_;
  bool has_ground_ = false;
  Eigen::Matrix4f shadow_projection_ = Eigen::Matrix4f::Identity();
  Eigen::Matrix3f shadow_axes_ = Eigen::Matrix3f::Identity();
  Eigen::Matrix4f underside_projection_ = Eigen::Matrix4f::Identity();
};

}  // namespace deforma
