#include <gtest/gtest.h>

#include "picture.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

RendererSettings small() {
  RendererSettings settings{160, 90, {}};
  settings.detail.shadow_size = 512;
  return settings;
}

// Seen along its normal, metal shows the ceiling in its own colour, (0.75 + 0.35) of the sky when it is rough, and
// scatters nothing.
TEST(Look, MetalMirrorsTheSkyInItsColour) {
  FrameContent frame = from_above(9.0);
  frame.light.intensity = 0.0f;
  frame.light.ambient = 0.5f;
  const Shape sheet = rectangle({0, 0, 0}, {3, 0, 0}, {0, 3, 0});
  const Vector3f gold(0.9f, 0.7f, 0.4f);
  frame.meshes = {sheet.drawn({.color = gold, .roughness = 1.0f, .metallic = 1.0f})};
  const auto p = pixel(Renderer(small()).draw(frame), 80, 45);
  Vector3d radiance;
  for (int i = 0; i < 3; ++i) radiance[i] = 0.5 * (0.75 + 0.35) * to_linear(gold[i]);
  const double least = radiance.minCoeff(), offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(p[i], to_srgb(radiance[static_cast<Eigen::Index>(i)] - offset), 2.0) << "channel " << i;
}

TEST(Look, PolishedMetalShowsCeilingAndWallsWherePaintIsEven) {
  FrameContent frame;
  frame.camera.eye = {0, -6, 0.01};
  frame.camera.field_of_view = 35.0;
  frame.light.intensity = 0.0f;
  const Shape body = ball({0, 0, 0}, 1.5, 64);
  const auto contrast = [&](float metallic) {
    frame.meshes = {body.drawn({.color = {0.8f, 0.8f, 0.8f}, .roughness = 0.1f, .metallic = metallic})};
    const Image image = Renderer(small()).draw(frame);
    // Upper half of the ball: reflects the ceiling above, the walls near the middle.
    return std::pair(brightness(image, 80, 22), brightness(image, 80, 42));
  };
  const auto [metal_ceiling, metal_wall] = contrast(1.0f);
  const auto [paint_high, paint_middle] = contrast(0.0f);
  EXPECT_GT(metal_ceiling, metal_wall + 150);
  EXPECT_LT(std::abs(paint_high - paint_middle), 150);
}

TEST(Look, AStopDoublesAllLightButNotTheBackground) {
  const Shape body = ball({0, 0, 0}, 1.0, 32);
  const DrawnGround ground{-1.0, {0.4f, 0.4f, 0.4f}};
  FrameContent frame;
  frame.camera.eye = {3, -6, 3};
  frame.ground = &ground;
  frame.meshes = {body.drawn({.color = {0.3f, 0.3f, 0.3f}})};
  Renderer renderer(small());
  const Image plain = renderer.draw(frame);
  frame.light.exposure = 1.0f;
  const Image exposed = renderer.draw(frame);
  frame.light.exposure = 0.0f;
  frame.light.intensity *= 2.0f;
  frame.light.ambient *= 2.0f;
  EXPECT_LE(largest_difference(exposed, renderer.draw(frame)), 1);
  EXPECT_GT(brightness(exposed, 80, 45), brightness(plain, 80, 45) + 60);
  EXPECT_NEAR(brightness(exposed, 80, 0), brightness(plain, 80, 0), 6);
}

// Two triangles: their outline and the diagonal, a pixel wide, in the colour given, whatever the light.
TEST(Look, EdgesAreDrawnOverTheirTriangles) {
  FrameContent frame = from_above(9.0);
  const Shape sheet = rectangle({0.05, 0.05, 0}, {2, 0, 0}, {0, 2, 0});
  for (const Antialiasing& kind : {Antialiasing{1, 1}, Antialiasing{4, 1}, Antialiasing{1, 2}})
    for (const float opacity : {1.0f, 0.4f}) {
      frame.meshes = {sheet.drawn(
          {.color = {0.9f, 0.9f, 0.9f}, .opacity = opacity, .edges = Vector3f(0.0f, 0.0f, 0.9f)})};
      RendererSettings settings = small();
      settings.detail.antialiasing = kind;
      settings.detail.fits_machine = false;
      const Image image = Renderer(settings).draw(frame);
      const auto is_blue = [&](int x, int y) { return pixel(image, x, y)[2] > pixel(image, x, y)[0] + 50; };
      int across = 0;
      for (int x = 0; x < 160; ++x) across += is_blue(x, 50);
      EXPECT_GE(across, 3) << name_of(kind);
      EXPECT_LE(across, 6) << name_of(kind);
      EXPECT_FALSE(is_blue(80, 30)) << "the inside of a triangle";
      EXPECT_TRUE(is_blue(80, 44) || is_blue(81, 44)) << "the diagonal";
    }
}

TEST(Look, EdgesBehindABodyAreHidden) {
  FrameContent frame = from_above(9.0);
  const Shape sheet = rectangle({0, 0, -1}, {2, 0, 0}, {0, 2, 0}),
              cover = rectangle({0, 0, 0}, {3, 0, 0}, {0, 3, 0});
  frame.meshes = {cover.drawn({})};
  Renderer renderer(small());
  const Image covered = renderer.draw(frame);
  frame.meshes = {cover.drawn({}), sheet.drawn({.edges = Vector3f(0.0f, 0.0f, 0.9f)})};
  EXPECT_LT(share_of_different(covered, renderer.draw(frame), 12), 0.001);
}

// Parallel rays: a bar that runs away from the eye stays as wide, and a sphere is as large, near and far.
TEST(Look, OrthographicKeepsWidths) {
  FrameContent frame;
  frame.camera.eye = {0, -10, 10};
  frame.camera.height = 9.0;  // 10 pixels a metre
  frame.background = {0, 0, 0};
  const Shape bar = rectangle({0, 0, 0}, {1, 0, 0}, {0, 20, 0});
  const Look red{.color = {0.9f, 0.05f, 0.05f}, .roughness = 0.8f};
  frame.meshes = {bar.drawn(red)};
  Renderer renderer(small());
  const auto width = [](const Image& image, int y) {
    int count = 0;
    for (int x = 0; x < 160; ++x) count += pixel(image, x, y)[0] > 40;
    return count;
  };
  const Image bars = renderer.draw(frame);
  for (const int y : {5, 45, 85}) EXPECT_NEAR(width(bars, y), 20, 1) << y;
  frame.meshes.clear();
  const std::vector<Vector3d> centers = {{0, 3, 0}, {0, -3, 0}};
  frame.spheres = {{centers, 1.0, red}};
  const Image spheres = renderer.draw(frame);
  const int offset = static_cast<int>(std::lround(30.0 * std::sqrt(0.5)));
  for (const int y : {45 - offset, 45 + offset}) {
    EXPECT_NEAR(width(spheres, y), 20, 2) << y;
    EXPECT_NEAR(width(spheres, y + 8), 12, 3) << y;  // 2 sqrt(100 - 64)
  }
}

TEST(Look, OrthographicSpheresLookLikeMeshes) {
  FrameContent frame;
  frame.camera.eye = {3, -6, 3};
  frame.camera.height = 6.0;
  const DrawnGround ground{-1.5, {0.7f, 0.7f, 0.7f}};
  frame.ground = &ground;
  const Shape body = ball({0.3, 0, 0}, 1.5, 96);
  const std::vector<Vector3d> centers = {{0.3, 0, 0}};
  Renderer renderer(small());
  frame.meshes = {body.drawn({})};
  const Image mesh = renderer.draw(frame);
  frame.meshes.clear();
  frame.spheres = {{centers, 1.5, {}}};
  EXPECT_LT(share_of_different(mesh, renderer.draw(frame), 12), 0.03);
}

TEST(Look, ContactIsDarkerThanOpenGround) {
  const Shape body = ball({0, 0, 0}, 1.0, 48);
  const DrawnGround ground{-1.0, {0.7f, 0.7f, 0.7f}};
  FrameContent frame;
  frame.camera.eye = {0, -6, 1.5};
  frame.ground = &ground;
  frame.light.intensity = 0.0f;  // only the sky: nothing is a shadow of the key light
  frame.meshes = {body.drawn({})};
  for (const std::string_view quality : quality_names()) {
    RendererSettings settings = small();
    settings.detail = detail_of(quality);
    const Image image = Renderer(settings).draw(frame);
    int bottom = 0;  // the lowest pixel of the ball in the middle of the picture, which is red
    for (int y = 0; y < 90; ++y)
      if (pixel(image, 80, y)[0] > pixel(image, 80, y)[2] + 20) bottom = y;
    EXPECT_LT(brightness(image, 80, bottom + 3), 0.75 * brightness(image, 10, 80)) << quality;
    EXPECT_LT(brightness(image, 80, bottom + 3), brightness(image, 80, bottom + 12)) << quality;
  }
}

}  // namespace
}  // namespace deforma
