#include "render/renderer.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "render/frame_uniforms.hpp"
#include "render/geometry.hpp"
#include "render/gl.hpp"
#include "render/light_pass.hpp"
#include "render/pass_clock.hpp"
#include "render/scene_fit.hpp"
#include "render/shaders.hpp"

namespace deforma {
namespace {

// The ground ends where it has faded into the backdrop, so many radii of the content from its center.
constexpr double ground_reach = 9.0;

float linear(float srgb) {
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

Eigen::Vector3f linear(const Eigen::Vector3f& srgb) {
  return {linear(srgb.x()), linear(srgb.y()), linear(srgb.z())};
}

Eigen::Vector4f joined(const Eigen::Vector3f& xyz, float w) { return {xyz.x(), xyz.y(), xyz.z(), w}; }

void check_settings(const RendererSettings& settings) {
  if (settings.width <= 0 || settings.height <= 0)
    throw std::invalid_argument(
        fmt::format("the picture's size must be positive, not {} x {}", settings.width, settings.height));
  if (settings.samples < 1)
    throw std::invalid_argument(fmt::format("samples per pixel must be 1 or more, not {}", settings.samples));
  if (settings.shadow_size < 0)
    throw std::invalid_argument(
        fmt::format("the shadow map's size must be 0 (no shadow) or more, not {}", settings.shadow_size));
}

void check_limits(const RendererSettings& settings) {
  GLint picture = 0, texture = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &picture);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  if (settings.width > picture || settings.height > picture)
    throw std::invalid_argument(
        fmt::format("a picture of {} x {} is too large: this driver draws at most {} x {}", settings.width,
                    settings.height, picture, picture));
  if (settings.shadow_size > texture)
    throw std::invalid_argument(
        fmt::format("a shadow map of {0} x {0} is too large: this driver has at most {1} x {1}",
                    settings.shadow_size, texture));
}

}  // namespace

struct Renderer::Data {
  Data(const RendererSettings& wanted, const ContextRequest& request) : settings(wanted), context(request) {
    check_limits(settings);
    const bool sample_mask = epoxy_gl_version() >= 40;
    const ShaderSources sources(sample_mask);
    mesh.emplace("mesh", sources.mesh.vertex, sources.mesh.fragment);
    glass.emplace("glass", sources.glass.vertex, sources.glass.fragment);
    glass_edge.emplace("glass edge", sources.glass_edge.vertex, sources.glass_edge.fragment);
    sphere.emplace("sphere", sources.sphere.vertex, sources.sphere.fragment);
    ground.emplace("ground", sources.ground.vertex, sources.ground.fragment);
    backdrop.emplace("backdrop", sources.backdrop.vertex, sources.backdrop.fragment);
    for (const auto* program : {&mesh, &glass, &glass_edge, &sphere, &ground, &backdrop}) {
      (*program)->bind_block("Frame", ShaderPlaces::frame_block);
      (*program)->bind_sampler("shadow_map", ShaderPlaces::shadow_map);
      (*program)->bind_sampler("shadow_depths", ShaderPlaces::shadow_depths);
      (*program)->bind_sampler("ground_light", ShaderPlaces::ground_light);
      (*program)->bind_sampler("color_map", ShaderPlaces::color_map);
    }
    if (settings.shadow_size > 0) light.emplace(sources, settings.shadow_size);
    make_targets();
  }

  void make_targets() {
    GLint most = 1;
    glGetIntegerv(GL_MAX_SAMPLES, &most);
    settings.samples = std::min({settings.samples, static_cast<int>(most), max_samples});
    // One sample is what a target without multisampling has.
    const GLsizei multisamples = settings.samples > 1 ? settings.samples : 0;
    glBindRenderbuffer(GL_RENDERBUFFER, color.id());
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, multisamples, GL_SRGB8_ALPHA8, settings.width,
                                     settings.height);
    glBindRenderbuffer(GL_RENDERBUFFER, depth.id());
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, multisamples, GL_DEPTH_COMPONENT32F, settings.width,
                                     settings.height);
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth.id());
    gl::check_framebuffer("the picture");
    GLint granted = 0;
    glGetIntegerv(GL_SAMPLES, &granted);
    settings.samples = std::clamp(static_cast<int>(granted), 1, max_samples);
    for (int i = 0; i < settings.samples; ++i) {
      float spot[2] = {0.5f, 0.5f};
      if (granted > 1) glGetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(i), spot);
      uniforms.samples.col(i) << spot[0] - 0.5f, spot[1] - 0.5f, 0.0f, 0.0f;
    }
    glBindRenderbuffer(GL_RENDERBUFFER, resolved_color.id());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_SRGB8_ALPHA8, settings.width, settings.height);
    glBindFramebuffer(GL_FRAMEBUFFER, resolved.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, resolved_color.id());
    gl::check_framebuffer("the resolved picture");
    gl::check_errors("making the picture's buffers");
  }

  /// Everything the shaders know of the frame; true when shadows are to be drawn.
  bool fit(const FrameContent& frame, const SceneBounds& bounds) {
    const double aspect = static_cast<double>(settings.width) / settings.height;
    Camera camera = frame.camera;
    camera.eye -= frame.camera.target;
    camera.target.setZero();
    const Eigen::Matrix4d view = view_matrix(camera);
    const double radius = bounds.content.empty() ? 0.3 * camera.eye.norm() : bounds.content.radius();
    const DepthRange range = fit_depth(bounds, camera.eye, ground_reach * radius);
    const Eigen::Vector3d to_light = -frame.light.direction.normalized();
    if (!to_light.allFinite() || to_light.norm() == 0.0)
      throw std::invalid_argument("the light's direction must be finite and not zero");

    uniforms.clip =
        (projection_matrix(camera, aspect, range.near_plane, range.far_plane) * view).cast<float>();
    uniforms.eye = joined(camera.eye.cast<float>(), 1.0f);
    uniforms.key_to = joined(to_light.cast<float>(), 0.0f);
    uniforms.key = joined(frame.light.intensity * linear(frame.light.color), frame.light.ambient);
    // From behind the scene and above, on the side away from the key light, so that outlines stand out.
    const Eigen::Vector3d right = view.row(0).head<3>(), back = view.row(2).head<3>();
    const double side = to_light.dot(right) > 0.0 ? -0.7 : 0.7;
    const Eigen::Vector3d rim = (side * right - 0.8 * back + Eigen::Vector3d(0.0, 0.0, 0.7)).normalized();
    uniforms.rim_to = joined(rim.cast<float>(), 1.0f);
    uniforms.rim = joined(Eigen::Vector3f::Constant(0.28f * frame.light.intensity), 0.0f);
    // Without a floor the light from below is that of the backdrop.
    uniforms.bounce = joined(
        frame.ground ? linear(frame.ground->color) : Eigen::Vector3f(0.4f * linear(frame.background)), 0.0f);
    uniforms.background = joined(linear(frame.background), 0.0f);
    uniforms.viewport << static_cast<float>(settings.width), static_cast<float>(settings.height),
        static_cast<float>(aspect), static_cast<float>(settings.samples);
    const Eigen::Vector3d center =
        bounds.content.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : bounds.content.center();
    uniforms.ground =
        Eigen::Vector4d(bounds.ground, center.x(), center.y(), ground_reach * radius).cast<float>();
    drop = static_cast<float>(2e-4 * radius);
    return light && light->fit(bounds, to_light, uniforms);
  }

  /// What `base_color` looks values up in.
  void upload_colors(const ColorMap& map) const {
    std::vector<Rgb> texels(map.colors.begin(), map.colors.end());
    texels.insert(texels.end(), {map.below, map.above, map.undefined});
    glActiveTexture(GL_TEXTURE0 + ShaderPlaces::color_map);
    glBindTexture(GL_TEXTURE_2D, color_map.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8, static_cast<GLsizei>(texels.size()), 1, 0, GL_RGB,
                 GL_UNSIGNED_BYTE, texels.data());
  }

  void use(const gl::Program& program, const Look& look, bool by_value) const {
    glUseProgram(program.id());
    const Eigen::Vector3f color_linear = linear(look.color);
    glUniform4f(program.at("color"), color_linear.x(), color_linear.y(), color_linear.z(), look.opacity);
    glUniform2f(program.at("finish"), look.roughness, look.flat ? 1.0f : 0.0f);
    glUniform1i(program.at("by_value"), by_value ? 1 : 0);
  }

  void draw_spheres(const UploadedSpheres& spheres) const {
    use(*sphere, spheres.look, spheres.by_value);
    glUniform1f(sphere->at("radius"), spheres.radius);
    spheres.draw();
  }

  void draw_opaque(bool with_ground) const {
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    for (const UploadedMesh& uploaded : geometry.meshes()) {
      if (uploaded.look.opacity < 1.0f) continue;
      use(*mesh, uploaded.look, uploaded.by_value);
      uploaded.draw();
    }
    for (const UploadedSpheres& spheres : geometry.spheres())
      if (spheres.look.opacity >= 1.0f) draw_spheres(spheres);
    glBindVertexArray(empty.id());
    if (with_ground) draw_ground();
    // Last and at the far end: only where nothing else is.
    glDepthFunc(GL_LEQUAL);
    glUseProgram(backdrop->id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_LESS);
  }

  /// The side that is turned away from the eye, or the one that is turned to it.
  void draw_glass(const std::vector<const UploadedMesh*>& order, bool far_side) const {
    glEnable(GL_CULL_FACE);
    for (const UploadedMesh* uploaded : order) {
      glCullFace(far_side != uploaded->inside_out ? GL_FRONT : GL_BACK);
      use(*glass, uploaded->look, uploaded->by_value);
      uploaded->draw();
    }
    glDisable(GL_CULL_FACE);
  }

  /// Far bodies before near ones, of each the side turned away before the side turned here.
  void draw_translucent() const {
    std::vector<const UploadedMesh*> order;
    for (const UploadedMesh& uploaded : geometry.meshes())
      if (uploaded.look.opacity < 1.0f) order.push_back(&uploaded);
    std::stable_sort(order.begin(), order.end(),
                     [](const UploadedMesh* a, const UploadedMesh* b) { return a->distance > b->distance; });
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    for (const UploadedSpheres& spheres : geometry.spheres())
      if (spheres.look.opacity < 1.0f) draw_spheres(spheres);
    // What is behind, times the share that passes, which the shader gives for each colour.
    glBlendFunc(GL_ONE, GL_SRC1_COLOR);
    draw_glass(order, true);
    for (const UploadedMesh* uploaded : order) {
      use(*glass_edge, uploaded->look, uploaded->by_value);
      uploaded->draw_edges();
    }
    draw_glass(order, false);
    glDepthMask(GL_TRUE);
  }

  Image read(const PixelBox& inner) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved.id());
    const int right = inner.x + inner.width, top = inner.y + inner.height;
    glBlitFramebuffer(inner.x, inner.y, right, top, inner.x, inner.y, right, top, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    clock.end_resolve();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved.id());
    Image image;
    image.width = settings.width;
    image.height = settings.height;
    const std::size_t row = 4 * static_cast<std::size_t>(settings.width);
    image.rgba.resize(row * static_cast<std::size_t>(settings.height));
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, settings.width, settings.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
    gl::check_errors("drawing a frame");
    // OpenGL counts rows from below.
    for (std::size_t low = 0, high = image.rgba.size() - row; low < high; low += row, high -= row)
      std::swap_ranges(image.rgba.begin() + static_cast<std::ptrdiff_t>(low),
                       image.rgba.begin() + static_cast<std::ptrdiff_t>(low + row),
                       image.rgba.begin() + static_cast<std::ptrdiff_t>(high));
    return image;
  }

  /// Floor and backdrop have no edges that need more than one sample: outside the content's frame they go straight into the
  /// resolved picture, which on a software driver saves most of the cost of multisampling.
  void draw_surroundings(const PixelBox& inner, bool with_ground) const {
    glBindFramebuffer(GL_FRAMEBUFFER, resolved.id());
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(empty.id());
    const int w = settings.width, h = settings.height;
    const PixelBox strips[] = {{0, 0, w, inner.y},
                               {0, inner.y + inner.height, w, h - inner.y - inner.height},
                               {0, inner.y, inner.x, inner.height},
                               {inner.x + inner.width, inner.y, w - inner.x - inner.width, inner.height}};
    for (const PixelBox& strip : strips) {
      if (strip.width <= 0 || strip.height <= 0) continue;
      glScissor(strip.x, strip.y, strip.width, strip.height);
      glUseProgram(backdrop->id());
      glDrawArrays(GL_TRIANGLES, 0, 3);
      if (with_ground) draw_ground();
    }
    glEnable(GL_DEPTH_TEST);
  }

  void draw_ground() const {
    glUseProgram(ground->id());
    glUniform1f(ground->at("drop"), drop);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }

  Image draw(const FrameContent& frame) {
    clock.begin_frame();
    const SceneBounds bounds = geometry.upload(frame);
    clock.end_upload();
    const bool shadows = fit(frame, bounds);
    if (frame.color_scale) upload_colors(*frame.color_scale->map);
    glBindBuffer(GL_UNIFORM_BUFFER, block.id());
    glBufferData(GL_UNIFORM_BUFFER, sizeof uniforms, &uniforms, GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, ShaderPlaces::frame_block, block.id());
    if (shadows) light->draw(geometry);
    clock.end_shadow();
    const PixelBox inner = bounds_in_picture(bounds.content, uniforms.clip, settings.width, settings.height);
    const bool with_ground = frame.ground != nullptr;
    glViewport(0, 0, settings.width, settings.height);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_SCISSOR_TEST);
    draw_surroundings(inner, with_ground);
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    glScissor(inner.x, inner.y, inner.width, inner.height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_opaque(with_ground);
    draw_translucent();
    clock.end_shading();
    glDisable(GL_SCISSOR_TEST);
    Image image = read(inner);
    glDisable(GL_FRAMEBUFFER_SRGB);
    clock.end_frame(cost);
    return image;
  }

  RendererSettings settings;
  Context context;  // before everything that lives in it
  std::optional<gl::Program> mesh, glass, glass_edge, sphere, ground, backdrop;
  std::optional<LightPass> light;
  gl::Renderbuffer color, depth, resolved_color;
  gl::Framebuffer target, resolved;
  gl::Texture color_map{GL_TEXTURE_2D};
  gl::VertexArray empty;
  gl::Buffer block;
  PassClock clock;
  DrawingCost cost;
  Geometry geometry;
  FrameUniforms uniforms;
  float drop = 0.0f;
};

Renderer::Renderer(const RendererSettings& settings, const ContextRequest& request) {
  check_settings(settings);
  data_ = std::make_unique<Data>(settings, request);
}

Renderer::~Renderer() {
  try {
    data_->context.make_current();
  } catch (const std::runtime_error&) {
    // Then its objects go with the context.
  }
}

Image Renderer::draw(const FrameContent& frame) {
  data_->context.make_current();
  return data_->draw(frame);
}

const ContextFacts& Renderer::facts() const { return data_->context.facts(); }

const DrawingCost& Renderer::cost() const { return data_->cost; }

}  // namespace deforma
