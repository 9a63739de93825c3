#include "render/renderer.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "render/frame_uniforms.hpp"
#include "render/geometry.hpp"
#include "render/gl.hpp"
#include "render/light_pass.hpp"
#include "render/pass_clock.hpp"
#include "render/picture_target.hpp"
#include "render/scene_fit.hpp"
#include "render/shaders.hpp"
#include "render/straight_alpha.hpp"

namespace deforma {
namespace {

// The ground ends where it has faded into the backdrop, so many radii of the content from its center.
constexpr double ground_reach = 9.0;

// Multisampling finds the edges of every triangle so many times, supersampling the colour of every pixel: on a software
// driver, whose every sample costs, the second is cheaper from about so many triangles on (README.md).
constexpr std::size_t many_triangles = 8000;

bool is_software(const ContextFacts& facts) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast"})
    if (facts.renderer.find(name) != std::string::npos) return true;
  return false;
}

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
  const Detail& detail = settings.detail;
  if (detail.antialiasing.samples < 1 || detail.antialiasing.grid < 1)
    throw std::invalid_argument(fmt::format("samples per pixel must be 1 or more, not {}",
                                            std::min(detail.antialiasing.samples, detail.antialiasing.grid)));
  if (detail.shadow_size < 0)
    throw std::invalid_argument(
        fmt::format("the shadow map's size must be 0 (no shadow) or more, not {}", detail.shadow_size));
  if (std::min({detail.ground_size, detail.sky_size, detail.body_taps, detail.blocker_taps,
                detail.ground_taps, detail.sky_taps}) < 1)
    throw std::invalid_argument("the maps of the ground and the taps of shadows must be 1 or more");
}

void check_limits(const RendererSettings& settings) {
  GLint picture = 0, texture = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &picture);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  if (settings.width > picture || settings.height > picture)
    throw std::invalid_argument(
        fmt::format("a picture of {} x {} is too large: this driver draws at most {} x {}", settings.width,
                    settings.height, picture, picture));
  const int map =
      std::max({settings.detail.shadow_size, settings.detail.ground_size, settings.detail.sky_size});
  if (map > texture)
    throw std::invalid_argument(fmt::format(
        "a shadow map of {0} x {0} is too large: this driver has at most {1} x {1}", map, texture));
}

}  // namespace

struct Renderer::Data {
  Data(const RendererSettings& wanted, const ContextRequest& request) : settings(wanted), context(request) {
    check_limits(settings);
    const bool sample_mask = epoxy_gl_version() >= 40;
    const ShaderSources sources(sample_mask, settings.detail);
    mesh.emplace("mesh", sources.mesh.vertex, sources.mesh.fragment);
    glass.emplace("glass", sources.glass.vertex, sources.glass.fragment);
    glass_edge.emplace("glass edge", sources.glass_edge.vertex, sources.glass_edge.fragment);
    sphere.emplace("sphere", sources.sphere.vertex, sources.sphere.fragment);
    wire.emplace("wire", sources.wire.vertex, sources.wire.fragment);
    ground.emplace("ground", sources.ground.vertex, sources.ground.fragment);
    backdrop.emplace("backdrop", sources.backdrop.vertex, sources.backdrop.fragment);
    for (const auto* program : {&mesh, &glass, &glass_edge, &sphere, &wire, &ground, &backdrop}) {
      (*program)->bind_block("Frame", ShaderPlaces::frame_block);
      (*program)->bind_sampler("shadow_map", ShaderPlaces::shadow_map);
      (*program)->bind_sampler("shadow_depths", ShaderPlaces::shadow_depths);
      (*program)->bind_sampler("ground_light", ShaderPlaces::ground_light);
      (*program)->bind_sampler("color_map", ShaderPlaces::color_map);
    }
    if (settings.detail.shadow_size > 0) light.emplace(sources, settings.detail);
    target.emplace(settings.width, settings.height);
  }

  /// Everything the shaders know of the frame; true when shadows are to be drawn.
  bool fit(const FrameContent& frame, const SceneBounds& bounds) {
    const double aspect = static_cast<double>(settings.width) / settings.height;
    Camera camera = frame.camera;
    camera.eye -= frame.camera.target;
    camera.target.setZero();
    const Eigen::Matrix4d view = view_matrix(camera);
    const double radius = bounds.content.empty() ? 0.3 * camera.eye.norm() : bounds.content.radius();
    const DepthRange range = camera.is_parallel()
                                 ? fit_parallel_depth(bounds, camera.eye, ground_reach * radius)
                                 : fit_depth(bounds, camera.eye, ground_reach * radius);
    const Eigen::Vector3d to_light = -frame.light.direction.normalized();
    if (!to_light.allFinite() || to_light.norm() == 0.0)
      throw std::invalid_argument("the light's direction must be finite and not zero");

    uniforms.clip =
        (projection_matrix(camera, aspect, range.near_plane, range.far_plane) * view).cast<float>();
    uniforms.eye = joined(camera.eye.cast<float>(), 1.0f);
    uniforms.back = joined(camera.eye.normalized().cast<float>(), camera.is_parallel() ? 1.0f : 0.0f);
    uniforms.key_to = joined(to_light.cast<float>(), 0.0f);
    const float exposure = std::exp2(frame.light.exposure);
    const float intensity = exposure * frame.light.intensity;
    uniforms.key = joined(intensity * linear(frame.light.color), exposure * frame.light.ambient);
    // From behind the scene and above, on the side away from the key light, so that outlines stand out.
    const Eigen::Vector3d right = view.row(0).head<3>(), back = view.row(2).head<3>();
    const double side = to_light.dot(right) > 0.0 ? -0.7 : 0.7;
    const Eigen::Vector3d rim = (side * right - 0.8 * back + Eigen::Vector3d(0.0, 0.0, 0.7)).normalized();
    uniforms.rim_to = joined(rim.cast<float>(), 1.0f);
    uniforms.rim = joined(Eigen::Vector3f::Constant(0.28f * intensity), 0.0f);
    // Without a floor the light from below is that of the backdrop.
    uniforms.bounce = joined(
        frame.ground ? linear(frame.ground->color) : Eigen::Vector3f(0.4f * linear(frame.background)), 0.0f);
    uniforms.background = joined(linear(frame.background), 0.0f);
    uniforms.viewport << static_cast<float>(settings.width), static_cast<float>(settings.height),
        static_cast<float>(aspect), static_cast<float>(target->antialiasing().samples);
    uniforms.samples = target->samples();
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
    glUniform3f(program.at("finish"), look.roughness, look.flat ? 1.0f : 0.0f, look.metallic);
    glUniform1i(program.at("by_value"), by_value ? 1 : 0);
  }

  void draw_spheres(const UploadedSpheres& spheres) const {
    use(*sphere, spheres.look, spheres.by_value);
    glUniform1f(sphere->at("radius"), spheres.radius);
    spheres.draw();
  }

  void draw_opaque() const {
    for (const UploadedMesh& uploaded : geometry.meshes()) {
      if (uploaded.look.opacity < 1.0f) continue;
      use(*mesh, uploaded.look, uploaded.by_value);
      uploaded.draw();
    }
    for (const UploadedSpheres& spheres : geometry.spheres())
      if (spheres.look.opacity >= 1.0f) draw_spheres(spheres);
  }

  void draw_surroundings(bool with_ground) const {
    glBindVertexArray(empty.id());
    if (with_ground) {
      glUseProgram(ground->id());
      glUniform1f(ground->at("drop"), drop);
      glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }
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
  void draw_translucent(bool transparent) const {
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
    // What is behind, times the share that passes, which the shader gives for each colour; over nothing for alpha, too.
    if (transparent)
      glBlendFunc(GL_ONE, GL_SRC1_COLOR);
    else
      glBlendFuncSeparate(GL_ONE, GL_SRC1_COLOR, GL_ZERO, GL_ONE);
    draw_glass(order, true);
    for (const UploadedMesh* uploaded : order) {
      use(*glass_edge, uploaded->look, uploaded->by_value);
      uploaded->draw_edges();
    }
    draw_glass(order, false);
    glDepthMask(GL_TRUE);
  }

  /// The edges of every triangle of the meshes that ask for them: a pixel wide, a little in front of the surface.
  void draw_wires() const {
    float widths[2] = {1.0f, 1.0f};
    glGetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, widths);
    glLineWidth(std::min(static_cast<float>(target->antialiasing().grid), widths[1]));
    glDisable(GL_BLEND);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glEnable(GL_POLYGON_OFFSET_LINE);
    glPolygonOffset(-1.0f, -2.0f);
    glUseProgram(wire->id());
    for (const UploadedMesh& uploaded : geometry.meshes()) {
      if (!uploaded.look.edges) continue;
      const Eigen::Vector3f color = linear(*uploaded.look.edges);
      glUniform3f(wire->at("color"), color.x(), color.y(), color.z());
      uploaded.draw();
    }
    glDisable(GL_POLYGON_OFFSET_LINE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glLineWidth(1.0f);
  }

  /// Floor and backdrop have no edges that need more than one sample: outside the content's frame they go straight into the
  /// plain picture, which on a software driver saves most of the cost of antialiasing.
  void draw_around(const PixelBox& inner, bool with_ground) {
    upload_uniforms(1);
    target->bind_plain();
    glScissor(0, 0, settings.width, settings.height);
    begin_drawing(false);
    const int w = settings.width, h = settings.height;
    const PixelBox strips[] = {{0, 0, w, inner.y},
                               {0, inner.y + inner.height, w, h - inner.y - inner.height},
                               {0, inner.y, inner.x, inner.height},
                               {inner.x + inner.width, inner.y, w - inner.x - inner.width, inner.height}};
    for (const PixelBox& strip : strips) {
      if (strip.width <= 0 || strip.height <= 0) continue;
      target->clip_plain(strip);
      draw_surroundings(with_ground);
    }
  }

  Antialiasing fitting_antialiasing(const FrameContent& frame) const {
    const Antialiasing& wanted = settings.detail.antialiasing;
    if (!settings.detail.fits_machine || !is_software(context.facts())) return wanted;
    std::size_t triangles = 0;
    for (const DrawnMesh& drawn : frame.meshes) triangles += drawn.triangles.size();
    return triangles < many_triangles ? wanted : Antialiasing{1, 2};
  }

  void upload_uniforms(int grid) {
    uniforms.background.w() = 1.0f / static_cast<float>(grid);
    glBindBuffer(GL_UNIFORM_BUFFER, block.id());
    glBufferData(GL_UNIFORM_BUFFER, sizeof uniforms, &uniforms, GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, ShaderPlaces::frame_block, block.id());
  }

  static void begin_drawing(bool transparent) {
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(transparent ? GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT : GL_DEPTH_BUFFER_BIT);
  }

  Image draw(const FrameContent& frame) {
    clock.begin_frame();
    const SceneBounds bounds = geometry.upload(frame);
    clock.end_upload();
    target->use(fitting_antialiasing(frame));
    const bool shadows = fit(frame, bounds);
    if (frame.color_scale) upload_colors(*frame.color_scale->map);
    upload_uniforms(1);
    if (shadows) {
      light->draw(geometry);
      clock.end_shadow();
    }
    const bool all = target->is_plain() || frame.transparent;
    const PixelBox inner =
        all ? PixelBox{0, 0, settings.width, settings.height}
            : bounds_in_picture(bounds.content, uniforms.clip, settings.width, settings.height);
    const bool with_ground = frame.ground != nullptr;
    glEnable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_SCISSOR_TEST);
    if (!all) draw_around(inner, with_ground);
    upload_uniforms(target->antialiasing().grid);
    target->bind_fine();
    target->clip_fine(inner);
    begin_drawing(frame.transparent);
    draw_opaque();
    if (!frame.transparent) draw_surroundings(with_ground);
    draw_translucent(frame.transparent);
    draw_wires();
    clock.end_shading();
    glDisable(GL_SCISSOR_TEST);
    target->resolve(inner);
    clock.end_resolve();
    Image image = target->read();
    glDisable(GL_FRAMEBUFFER_SRGB);
    clock.end_frame(cost);
    if (frame.transparent) make_straight(image);
    return image;
  }

  RendererSettings settings;
  Context context;  // before everything that lives in it
  std::optional<gl::Program> mesh, glass, glass_edge, sphere, wire, ground, backdrop;
  std::optional<LightPass> light;
  gl::Texture color_map{GL_TEXTURE_2D};
  std::optional<PictureTarget> target;
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

const Antialiasing& Renderer::antialiasing() const { return data_->target->antialiasing(); }

}  // namespace deforma
