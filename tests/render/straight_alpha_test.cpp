#include "render/straight_alpha.hpp"

#include <gtest/gtest.h>

#include "picture.hpp"

namespace deforma {
namespace {

Image one_pixel(int r, int g, int b, int a) {
  Image image{1, 1, {}};
  for (const int level : {r, g, b, a}) image.rgba.push_back(static_cast<std::uint8_t>(level));
  return image;
}

/// What blending leaves of a colour at an alpha: sRGB codes of linear light times alpha.
Image blended(int r, int g, int b, int a) {
  const auto byte = [&](int level) {
    return static_cast<int>(std::lround(to_srgb(to_linear(level / 255.0) * a / 255.0)));
  };
  return one_pixel(byte(r), byte(g), byte(b), a);
}

TEST(StraightAlpha, GivesBackTheColourAtEveryAlpha) {
  for (const int alpha : {64, 128, 200, 254, 255}) {
    Image image = alpha == 255 ? one_pixel(230, 128, 60, 255) : blended(230, 128, 60, alpha);
    make_straight(image);
    const auto p = pixel(image, 0, 0);
    EXPECT_NEAR(p[0], 230, 3) << alpha;
    EXPECT_NEAR(p[1], 128, 3) << alpha;
    EXPECT_NEAR(p[2], 60, 3) << alpha;
    EXPECT_EQ(p[3], alpha);
  }
}

TEST(StraightAlpha, LightBeyondItsAlphaIsKept) {
  Image image = one_pixel(200, 200, 200, 20);
  make_straight(image);
  const auto p = pixel(image, 0, 0);
  EXPECT_EQ(p[0], 255);
  EXPECT_NEAR(p[3], 255 * to_linear(200 / 255.0), 1) << "over black it is as bright as it was";
}

TEST(StraightAlpha, ColoursGoOnBeyondTheEdge) {
  Image image{9, 1, std::vector<std::uint8_t>(36)};
  for (const int channel : {0, 1, 2, 3})
    image.rgba[static_cast<std::size_t>(16 + channel)] = channel == 3 ? 255 : 90;
  make_straight(image);
  for (int x = 0; x < 9; ++x) {
    const auto p = pixel(image, x, 0);
    EXPECT_EQ(p[3], x == 4 ? 255 : 0) << x;
    EXPECT_EQ(p[0], std::abs(x - 4) <= 3 ? 90 : 0) << x;
  }
}

}  // namespace
}  // namespace deforma
