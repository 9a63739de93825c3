#include "render/color_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "picture.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// How those see linear light who lack the cones for green or for red (G. Machado, M. Oliveira, L. Fernandes 2009).
const Eigen::Matrix3d normal = Eigen::Matrix3d::Identity();
const Eigen::Matrix3d deuteranopia = (Eigen::Matrix3d() << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501,
                                      0.047413, -0.011820, 0.042940, 0.968881)
                                         .finished();
const Eigen::Matrix3d protanopia = (Eigen::Matrix3d() << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281,
                                    0.099216, -0.003882, -0.048116, 1.051998)
                                       .finished();

/// CIELAB of an sRGB colour (D65) as it is seen.
Vector3d lab(const Rgb& color, const Eigen::Matrix3d& vision = normal) {
  const Vector3d light(to_linear(color[0] / 255.0), to_linear(color[1] / 255.0), to_linear(color[2] / 255.0));
  const Eigen::Matrix3d xyz = (Eigen::Matrix3d() << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522,
                               0.0721750, 0.0193339, 0.1191920, 0.9503041)
                                  .finished();
  const Vector3d seen = (vision * light).cwiseMax(0.0).cwiseMin(1.0);
  Vector3d f = (xyz * seen).cwiseQuotient(Vector3d(0.95047, 1.0, 1.08883));
  for (double& v : f) v = v > 0.008856 ? std::cbrt(v) : 7.787 * v + 16.0 / 116.0;
  return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

/// To whom two colours look most alike.
double distance(const Rgb& a, const Rgb& b) {
  double least = 1e9;
  for (const Eigen::Matrix3d* vision : {&normal, &deuteranopia, &protanopia})
    least = std::min(least, (lab(a, *vision) - lab(b, *vision)).norm());
  return least;
}

TEST(ColorMap, EndsAndMiddlesAreAsPublished) {
  EXPECT_EQ(find_color_map("viridis").colors.front(), (Rgb{0x44, 0x01, 0x54}));
  EXPECT_EQ(find_color_map("viridis").colors.back(), (Rgb{0xfd, 0xe7, 0x25}));
  EXPECT_EQ(find_color_map("magma").colors.front(), (Rgb{0x00, 0x00, 0x04}));
  EXPECT_EQ(find_color_map("magma").colors.back(), (Rgb{0xfc, 0xfd, 0xbf}));
  EXPECT_EQ(find_color_map("cividis").colors.front(), (Rgb{0x00, 0x22, 0x4e}));
  EXPECT_EQ(find_color_map("cividis").colors.back(), (Rgb{0xfe, 0xe8, 0x38}));
  // Moreland 2009: (59, 76, 192) and (180, 4, 38) around (221, 221, 221).
  const ColorMap& coolwarm = find_color_map("coolwarm");
  EXPECT_EQ(coolwarm.colors.front(), (Rgb{59, 76, 192}));
  EXPECT_EQ(coolwarm.colors.back(), (Rgb{180, 4, 38}));
  EXPECT_EQ((ColorScale{&coolwarm, -1.0, 1.0}.color(0.0)), (Rgb{221, 221, 221}));
}

TEST(ColorMap, LightnessGrowsEvenlyAndADivergingMapFallsToBothSides) {
  for (const ColorMap& map : color_maps()) {
    // In steps of a sixteenth, so that rounding to 8 bits does not count.
    for (std::size_t k = 16; k < 256; k += 16) {
      const double step = lab(map.colors[k])[0] - lab(map.colors[k - 16])[0];
      if (!map.diverging) {
        const double mean = (lab(map.colors[255])[0] - lab(map.colors[0])[0]) / 16.0;
        EXPECT_GT(step, 0.5 * mean) << map.name << " at " << k;
        EXPECT_LT(step, 1.5 * mean) << map.name << " at " << k;
      } else if (k <= 112 || k > 144) {
        EXPECT_GT(k <= 112 ? step : -step, 0.0) << map.name << " at " << k;
      }
    }
  }
}

TEST(ColorMap, WhatHasNoPlaceInTheRangeLooksLikeNothingInItToAnyone) {
  for (const ColorMap& map : color_maps()) {
    for (const Rgb& own : {map.below, map.above, map.undefined})
      for (const Rgb& color : map.colors) EXPECT_GT(distance(own, color), 30.0) << map.name;
    EXPECT_GT(distance(map.below, map.above), 40.0) << map.name;
    EXPECT_GT(distance(map.below, map.undefined), 40.0) << map.name;
    EXPECT_GT(distance(map.above, map.undefined), 40.0) << map.name;
  }
}

TEST(ColorMap, AScaleFindsTheColourOfAnyValue) {
  const ColorMap& map = find_color_map("viridis");
  const ColorScale scale{&map, 100.0, 300.0};
  EXPECT_EQ(scale.color(100.0), map.colors[0]);
  EXPECT_EQ(scale.color(300.0), map.colors[255]);
  EXPECT_EQ(scale.color(100.0 + 200.0 * 51 / 255), map.colors[51]);
  EXPECT_EQ(scale.color(99.9), map.colors[0]) << "less than half a step outside";
  EXPECT_EQ(scale.color(99.0), map.below);
  EXPECT_EQ(scale.color(301.0), map.above);
  EXPECT_EQ(scale.color(-std::numeric_limits<double>::infinity()), map.below);
  EXPECT_EQ(scale.color(std::nan("")), map.undefined);
}

TEST(ColorMap, RefusesAnUnknownNameByTheKnown) {
  EXPECT_THAT([] { find_color_map("jet"); },
              testing::ThrowsMessage<std::invalid_argument>(testing::AllOf(
                  testing::HasSubstr("'jet'"), testing::HasSubstr("viridis, cividis, magma, coolwarm"))));
}

// Pictures by values, beside those of a body that has the map's colour all over.

RendererSettings small() {
  RendererSettings settings;
  settings.width = 160;
  settings.height = 90;
  settings.detail.shadow_size = 512;
  return settings;
}

Look look_of(const Rgb& color) { return {.color = Vector3f(color[0], color[1], color[2]) / 255.0f}; }

TEST(DrawByValue, EqualsADrawingInTheMapsColour) {
  Renderer renderer(small());
  const Shape shape = ball({0, 0, 0}, 3.0, 24);
  const std::vector<Vector3d> centers = {{-5, 0, 0}, {5, 1, 0}};
  for (const ColorMap& map : color_maps()) {
    const ColorScale scale{&map, -2.0, 6.0};
    for (double value : {-2.0, -0.3, 2.0, 5.1, 6.0, -2.5, 7.0, std::nan("")}) {
      FrameContent frame = from_above(9.0);
      const Look look = look_of(scale.color(value));
      frame.meshes = {shape.drawn(look)};
      frame.spheres = {{centers, 1.5, look}};
      const Image plain = renderer.draw(frame);
      frame.color_scale = &scale;
      const std::vector<float> values(shape.points.size(), static_cast<float>(value));
      frame.meshes[0].values = values;
      frame.spheres[0].values = std::span(values).first(2);
      frame.meshes[0].look = frame.spheres[0].look = look_of({0, 255, 0});  // is not seen
      EXPECT_LE(largest_difference(renderer.draw(frame), plain), 2) << map.name << " at " << value;
    }
  }
}

TEST(DrawByValue, LooksValuesUpAtEveryPixelNotAtTheVertices) {
  // One quad from below the range at the left to above it at the right: 16 m over 160 pixels, the range over its middle half.
  Renderer renderer(small());
  const ColorMap& map = find_color_map("viridis");
  const ColorScale scale{&map, 0.0, 1.0};
  const Shape sheet = rectangle({0, 0, 0}, {8.0, 0, 0}, {0, 2.0, 0});
  std::vector<float> values;
  for (const Vector3d& point : sheet.points) values.push_back(point.x() > 0.0 ? 1.5f : -0.5f);
  FrameContent frame = from_above(9.0);
  frame.light.intensity = 0.0f;
  frame.color_scale = &scale;
  frame.meshes = {sheet.drawn(look_of({0, 0, 0}))};
  frame.meshes[0].values = values;
  const Image image = renderer.draw(frame);
  for (int x : {10, 30, 45, 60, 80, 95, 110, 130, 150}) {
    FrameContent plain = from_above(9.0);
    plain.light.intensity = 0.0f;
    plain.meshes = {sheet.drawn(look_of(scale.color(-0.5 + 2.0 * (x + 0.5) / 160.0)))};
    const auto expected = pixel(renderer.draw(plain), x, 45), found = pixel(image, x, 45);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(found[c], expected[c], 3) << "column " << x << " channel " << c;
  }
}

TEST(DrawByValue, OfTwoFramesTheSecondMayHaveNone) {
  Renderer renderer(small());
  const Shape shape = ball({0, 0, 0}, 3.0, 12);
  const ColorScale scale{&find_color_map("magma"), 0.0, 1.0};
  FrameContent frame = from_above(9.0);
  frame.meshes = {shape.drawn(look_of({200, 90, 50}))};
  const Image plain = renderer.draw(frame);
  const std::vector<float> values(shape.points.size(), 0.3f);
  frame.color_scale = &scale;
  frame.meshes[0].values = values;
  EXPECT_GT(largest_difference(renderer.draw(frame), plain), 30);
  frame.meshes[0].values = {};
  EXPECT_EQ(largest_difference(renderer.draw(frame), plain), 0);
}

TEST(DrawByValue, GlassTakesItsTintFromTheValue) {
  Renderer renderer(small());
  const Shape shape = ball({0, 0, 0}, 3.0, 24);
  const ColorScale scale{&find_color_map("magma"), 0.0, 1.0};
  FrameContent frame = from_above(9.0);
  frame.meshes = {shape.drawn(look_of(scale.color(0.6)))};
  frame.meshes[0].look.opacity = 0.5f;
  const Image plain = renderer.draw(frame);
  const std::vector<float> values(shape.points.size(), 0.6f);
  frame.color_scale = &scale;
  frame.meshes[0].values = values;
  frame.meshes[0].look.color = {0.0f, 1.0f, 0.0f};
  EXPECT_LE(largest_difference(renderer.draw(frame), plain), 2);
}

TEST(DrawByValue, RefusesValuesThatDoNotFitOrHaveNoScale) {
  Renderer renderer(small());
  const Shape shape = ball({0, 0, 0}, 3.0, 6);
  const std::vector<float> values(shape.points.size(), 0.5f);
  const ColorScale upside_down{&find_color_map("magma"), 1.0, 1.0};
  FrameContent frame = from_above(9.0);
  frame.meshes = {shape.drawn({})};
  frame.meshes[0].values = values;
  const auto refused = [](const char* part) {
    return testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr(part));
  };
  EXPECT_THAT([&] { renderer.draw(frame); }, refused("mesh 0: values need a colour scale"));
  frame.color_scale = &upside_down;
  EXPECT_THAT([&] { renderer.draw(frame); }, refused("mesh 0: values need a colour scale"));
  frame.meshes[0].values = std::span(values).first(2);
  EXPECT_THAT([&] { renderer.draw(frame); }, refused("points with 2 values"));
}

}  // namespace
}  // namespace deforma
