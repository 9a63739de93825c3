#include "render/quality.hpp"

#include <gtest/gtest.h>

#include <set>

#include "picture.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr Antialiasing kinds[] = {{1, 1}, {4, 1}, {1, 2}, {4, 2}};

RendererSettings with(const Antialiasing& antialiasing) {
  RendererSettings settings{160, 90, {}};
  settings.detail.antialiasing = antialiasing;
  settings.detail.fits_machine = false;
  return settings;
}

TEST(Quality, NamesWhatItDoes) {
  EXPECT_EQ(name_of({1, 1}), "none");
  EXPECT_EQ(name_of({4, 1}), "4x multisampling");
  EXPECT_EQ(name_of({1, 2}), "2x2 supersampling");
  EXPECT_EQ(name_of({4, 2}), "2x2 supersampling of 4x multisampling");
  for (const std::string_view name : quality_names()) EXPECT_NO_THROW(detail_of(name));
  EXPECT_THROW(detail_of("best"), std::invalid_argument);
}

TEST(Quality, TakesMoreOfEverythingStepByStep) {
  const Detail draft = detail_of("draft"), standard = detail_of("standard"), best = detail_of("final");
  for (const auto part : {&Detail::shadow_size, &Detail::ground_size, &Detail::sky_size, &Detail::body_taps,
                          &Detail::blocker_taps, &Detail::ground_taps, &Detail::sky_taps}) {
    EXPECT_LT(draft.*part, standard.*part);
    EXPECT_LT(standard.*part, best.*part);
  }
  EXPECT_EQ(draft.antialiasing, (Antialiasing{1, 1}));
}

TEST(Quality, EveryAntialiasingMixesAnEdgeInLinearLight) {
  FrameContent frame = from_above(9.0);
  frame.background = {0.0f, 0.0f, 0.0f};
  frame.light.intensity = 0.0f;
  frame.light.ambient = 0.7f;
  const Shape sheet = rectangle({3.05, 0.0, 0.0}, {3.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
  frame.meshes = {sheet.drawn({.color = Vector3f(1.0f, 1.0f, 1.0f), .roughness = 1.0f})};
  for (const Antialiasing& kind : kinds) {
    if (kind == Antialiasing{}) continue;
    Renderer renderer(with(kind));
    const Image image = renderer.draw(frame);
    const double full = pixel(image, 90, 45)[0];
    EXPECT_EQ(pixel(image, 79, 45)[0], 0) << name_of(kind);
    EXPECT_NEAR(pixel(image, 80, 45)[0], to_srgb(0.5 * to_linear(full / 255.0)), 3.0) << name_of(kind);
    EXPECT_EQ(renderer.antialiasing(), kind);
  }
}

/// A ball, glass and the ground, with the content's frame inside the picture.
FrameContent still_life(const Shape& body, const Shape& jar, const DrawnGround& ground) {
  FrameContent frame;
  frame.camera.eye = {3, -6, 3};
  frame.ground = &ground;
  frame.meshes = {body.drawn({}), jar.drawn({.opacity = 0.2f})};
  return frame;
}

TEST(Quality, AntialiasingChangesOnlyEdges) {
  const Shape body = ball({0, 0, 0}, 0.8, 32), jar = ball({0, 0, 0.3}, 1.2, 32);
  const DrawnGround ground{-0.8, {0.7f, 0.7f, 0.7f}};
  const FrameContent frame = still_life(body, jar, ground);
  Renderer plain(with({1, 1}));
  const Image reference = plain.draw(frame);
  for (const Antialiasing& kind : kinds) {
    Renderer renderer(with(kind));
    EXPECT_LT(share_of_different(reference, renderer.draw(frame), 6), 0.06) << name_of(kind);
  }
}

TEST(Quality, DraftShowsTheSameShadowsAsFinal) {
  const Shape body = ball({0, 0, 0}, 0.8, 32), jar = ball({0, 0, 0.3}, 1.2, 32);
  const DrawnGround ground{-0.8, {0.7f, 0.7f, 0.7f}};
  const FrameContent frame = still_life(body, jar, ground);
  RendererSettings settings{160, 90, detail_of("draft")};
  Renderer draft(settings);
  settings.detail = detail_of("final");
  Renderer best(settings);
  EXPECT_LT(share_of_different(draft.draw(frame), best.draw(frame), 12), 0.05);
}

TEST(Quality, ManyTrianglesOnASoftwareDriverAreSupersampled) {
  RendererSettings settings{160, 90, {}};
  Renderer renderer(settings);
  if (renderer.facts().renderer.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "a graphics card";
  const Shape few = ball({0, 0, 0}, 1.0, 8), many = ball({0, 0, 0}, 1.0, 64);
  FrameContent frame = from_above(9.0);
  frame.meshes = {few.drawn({})};
  renderer.draw(frame);
  EXPECT_EQ(renderer.antialiasing(), (Antialiasing{4, 1}));
  frame.meshes = {many.drawn({})};
  renderer.draw(frame);
  EXPECT_EQ(renderer.antialiasing(), (Antialiasing{1, 2}));
}

// Where a level of the 8-bit output ends, both levels are mixed: means over small blocks take values between levels.
TEST(Quality, SlowGradientsShowNoBands) {
  const DrawnGround ground{-0.8, {0.7f, 0.7f, 0.7f}};
  for (const Antialiasing& kind : kinds) {
    FrameContent frame;
    frame.camera.eye = {3, -6, 3};
    frame.ground = &ground;
    RendererSettings settings = with(kind);
    settings.width = 320;
    settings.height = 180;
    Renderer renderer(settings);
    // Its frame fills the picture, so that all of it is smoothed.
    const Shape speck = ball(frame.camera.eye, 0.01, 4);
    frame.meshes = {speck.drawn({.opacity = 0.001f})};
    const Image image = renderer.draw(frame);
    int mixed = 0, blocks = 0;
    for (int y = 0; y + 8 <= 180; y += 8)
      for (int x = 0; x + 8 <= 320; x += 8) {
        std::set<int> levels;
        for (int i = 0; i < 64; ++i) levels.insert(pixel(image, x + i % 8, y + i / 8)[1]);
        ++blocks;
        mixed += levels.size() > 1;
        EXPECT_LE(*levels.rbegin() - *levels.begin(), 12) << name_of(kind);
      }
    EXPECT_GT(mixed, 0.7 * blocks) << name_of(kind);
  }
}

}  // namespace
}  // namespace deforma
