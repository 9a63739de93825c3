#include "render/light_pass.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace deforma {
namespace {

// Texels along the edge of the map of undersides.
constexpr int underside_size = 256;

// How wide the light looks from the scene: half its width over its distance.
constexpr double light_width = 0.10;
// Radius of the shadow filter on bodies, and how far the occlusion of the ground reaches, by radius of the
// casters.
constexpr double body_blur = 0.012;
constexpr double occlusion_reach = 0.8;

gl::Texture depth_texture(int size) {
  gl::Texture texture(GL_TEXTURE_2D);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  return texture;
}

gl::Texture color_texture(GLint format, int size) {
  gl::Texture texture(GL_TEXTURE_2D);
  glTexImage2D(GL_TEXTURE_2D, 0, format, size, size, 0, GL_RG, GL_UNSIGNED_BYTE, nullptr);
  return texture;
}

/// Outside a map everything is lit.
gl::Sampler lit_outside(GLint filter) {
  gl::Sampler sampler;
  const float border[] = {1.0f, 1.0f, 1.0f, 1.0f};
  glSamplerParameterfv(sampler.id(), GL_TEXTURE_BORDER_COLOR, border);
  glSamplerParameteri(sampler.id(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glSamplerParameteri(sampler.id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  glSamplerParameteri(sampler.id(), GL_TEXTURE_MIN_FILTER, filter);
  glSamplerParameteri(sampler.id(), GL_TEXTURE_MAG_FILTER, filter);
  return sampler;
}

void attach(const gl::Framebuffer& target, GLenum place, const gl::Texture& texture, const char* what) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, place, GL_TEXTURE_2D, texture.id(), 0);
  if (place == GL_DEPTH_ATTACHMENT) {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  }
  gl::check_framebuffer(what);
}

}  // namespace

LightPass::LightPass(const ShaderSources& sources, const Detail& detail)
    : mesh_depth_("mesh depth", sources.mesh_depth.vertex, sources.mesh_depth.fragment),
      sphere_depth_("sphere depth", sources.sphere_depth.vertex, sources.sphere_depth.fragment),
      ground_key_program_("ground key", sources.ground_key.vertex, sources.ground_key.fragment),
      ground_sky_program_("ground sky", sources.ground_sky.vertex, sources.ground_sky.fragment),
      ground_light_program_("ground light", sources.ground_light.vertex, sources.ground_light.fragment),
      shadow_map_(depth_texture(detail.shadow_size)),
      underside_(depth_texture(underside_size)),
      ground_key_(color_texture(GL_R8, detail.ground_size)),
      ground_sky_(color_texture(GL_R8, detail.sky_size)),
      ground_light_(color_texture(GL_RG8, detail.ground_size)),
      compare_(lit_outside(GL_LINEAR)),
      plain_(lit_outside(GL_NEAREST)),
      shadow_size_(detail.shadow_size),
      ground_size_(detail.ground_size),
      sky_size_(detail.sky_size) {
  glBindTexture(GL_TEXTURE_2D, ground_light_.id());
  glGenerateMipmap(GL_TEXTURE_2D);
  // Samplers rule over the other places; this one keeps its own state, for it has mipmaps.
  const float border[] = {1.0f, 1.0f, 1.0f, 1.0f};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, border);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glSamplerParameteri(compare_.id(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glSamplerParameteri(compare_.id(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  attach(shadow_target_, GL_DEPTH_ATTACHMENT, shadow_map_, "the shadow map");
  attach(underside_target_, GL_DEPTH_ATTACHMENT, underside_, "the map of undersides");
  attach(key_target_, GL_COLOR_ATTACHMENT0, ground_key_, "the ground's key light");
  attach(sky_target_, GL_COLOR_ATTACHMENT0, ground_sky_, "the ground's sky");
  attach(ground_target_, GL_COLOR_ATTACHMENT0, ground_light_, "the ground's light");
  for (const gl::Program* program :
       {&mesh_depth_, &sphere_depth_, &ground_key_program_, &ground_sky_program_, &ground_light_program_}) {
    program->bind_block("Frame", ShaderPlaces::frame_block);
    program->bind_sampler("shadow_map", ShaderPlaces::shadow_map);
    program->bind_sampler("shadow_depths", ShaderPlaces::shadow_depths);
    program->bind_sampler("underside", ShaderPlaces::underside);
    program->bind_sampler("ground_key", ShaderPlaces::ground_key);
    program->bind_sampler("ground_sky", ShaderPlaces::ground_sky);
  }
}

bool LightPass::fit(const SceneBounds& bounds, const Eigen::Vector3d& to_light, FrameUniforms& uniforms) {
  if (bounds.casters.empty() || bounds.casters.radius() == 0.0) return false;
  const double radius = bounds.casters.radius();
  const double blur = body_blur * radius;
  const ShadowFit shadow = fit_shadow(bounds.casters, to_light, 2.0 * blur);
  const double texel = shadow.width / shadow_size_;
  uniforms.shadow = shadow.matrix.cast<float>();
  uniforms.key_to.w() = 1.0f;
  uniforms.rim_to.w() = static_cast<float>(radius);
  uniforms.blur =
      Eigen::Vector4d(blur / shadow.width, blur, 1.5 * texel, light_width * shadow.depth / shadow.width)
          .cast<float>();
  shadow_projection_ = Eigen::Matrix4f::Identity();
  shadow_projection_.topLeftCorner<3, 3>() *= 2.0f;
  shadow_projection_.topRightCorner<3, 1>().setConstant(-1.0f);
  shadow_projection_ = shadow_projection_ * uniforms.shadow;
  const Eigen::Matrix3d turn = shadow.matrix.topLeftCorner<3, 3>();
  shadow_axes_.col(0) = turn.row(0).normalized().cast<float>();
  shadow_axes_.col(1) = turn.row(1).normalized().cast<float>();
  shadow_axes_.col(2) = -turn.row(2).normalized().cast<float>();

  has_ground_ = bounds.has_ground && to_light.z() > 0.02;
  if (!has_ground_) return true;
  const GroundRegion region = fit_ground(bounds, to_light, occlusion_reach * radius);
  uniforms.eye.w() = static_cast<float>(region.size.maxCoeff() / ground_size_);
  uniforms.bounce.w() = 1.0f;
  uniforms.region << region.min.cast<float>(), region.size.cwiseInverse().cast<float>();
  // Depth along the plane z = const by map coordinates: the ground's own share of the map's matrix.
  const Eigen::RowVector2d slope = turn.block<1, 2>(2, 0) * turn.topLeftCorner<2, 2>().inverse();
  const double height = std::max(bounds.casters.max.z() - bounds.ground, 1e-3 * radius);
  uniforms.plane = Eigen::Vector4d(slope.x(), slope.y(), 1.0 / shadow_size_, height).cast<float>();
  Eigen::Matrix4d up = Eigen::Matrix4d::Identity();
  up(0, 0) = 2.0 / region.size.x();
  up(1, 1) = 2.0 / region.size.y();
  up(2, 2) = 2.0 / height;
  up(0, 3) = -1.0 - up(0, 0) * region.min.x();
  up(1, 3) = -1.0 - up(1, 1) * region.min.y();
  up(2, 3) = -1.0 - up(2, 2) * bounds.ground;
  underside_projection_ = up.cast<float>();
  return true;
}

void LightPass::draw_depths(const Geometry& geometry, const gl::Framebuffer& target, int size,
                            const Eigen::Matrix4f& projection, const Eigen::Matrix3f& axes) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewport(0, 0, size, size);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(mesh_depth_.id());
  glUniformMatrix4fv(mesh_depth_.at("projection"), 1, GL_FALSE, projection.data());
  for (const UploadedMesh& mesh : geometry.meshes())
    if (mesh.look.opacity >= 1.0f) mesh.draw();
  glUseProgram(sphere_depth_.id());
  glUniformMatrix4fv(sphere_depth_.at("projection"), 1, GL_FALSE, projection.data());
  glUniformMatrix3fv(sphere_depth_.at("axes"), 1, GL_FALSE, axes.data());
  for (const UploadedSpheres& spheres : geometry.spheres()) {
    if (spheres.look.opacity < 1.0f) continue;
    glUniform1f(sphere_depth_.at("radius"), spheres.radius);
    spheres.draw();
  }
}

void LightPass::draw_texels(const gl::Program& program, const gl::Framebuffer& target, int size) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewport(0, 0, size, size);
  glUseProgram(program.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void LightPass::draw(const Geometry& geometry) {
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  // A body may reach through the ground or, by rounding, out of the map's depth: it shall count there, not be
  // cut.
  glEnable(GL_DEPTH_CLAMP);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 4.0f);
  draw_depths(geometry, shadow_target_, shadow_size_, shadow_projection_, shadow_axes_);
  glDisable(GL_POLYGON_OFFSET_FILL);
  if (has_ground_) {
    Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();
    axes(2, 2) = -1.0f;
    draw_depths(geometry, underside_target_, underside_size, underside_projection_, axes);
    bind();
    glDisable(GL_DEPTH_TEST);
    glBindVertexArray(empty_.id());
    draw_texels(ground_key_program_, key_target_, ground_size_);
    draw_texels(ground_sky_program_, sky_target_, sky_size_);
    draw_texels(ground_light_program_, ground_target_, ground_size_);
    glActiveTexture(GL_TEXTURE0 + ShaderPlaces::ground_light);
    glBindTexture(GL_TEXTURE_2D, ground_light_.id());
    glGenerateMipmap(GL_TEXTURE_2D);
    glEnable(GL_DEPTH_TEST);
  }
  glDisable(GL_DEPTH_CLAMP);
  bind();
}

void LightPass::bind() const {
  const auto place = [](int unit, const gl::Texture& texture, GLuint sampler) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glBindSampler(static_cast<GLuint>(unit), sampler);
  };
  place(ShaderPlaces::shadow_map, shadow_map_, compare_.id());
  place(ShaderPlaces::shadow_depths, shadow_map_, plain_.id());
  place(ShaderPlaces::underside, underside_, plain_.id());
  place(ShaderPlaces::ground_light, ground_light_, 0);
  place(ShaderPlaces::ground_key, ground_key_, 0);
  place(ShaderPlaces::ground_sky, ground_sky_, 0);
}

}  // namespace deforma
