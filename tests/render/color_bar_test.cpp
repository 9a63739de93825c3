#include "render/color_bar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "picture.hpp"

namespace deforma {
namespace {

ColorBar stress_bar(const char* map = "viridis") {
  return {{&find_color_map(map), 0.0, 20000.0}, "von Mises stress", "Pa", false};
}

Image plain(int width, int height, std::uint8_t grey, std::uint8_t alpha = 255) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) image.rgba.insert(image.rgba.end(), {grey, grey, grey, alpha});
  return image;
}

TEST(ColorBar, TicksAreRoundAndInside) {
  EXPECT_THAT(round_ticks(0.0, 20000.0), testing::ElementsAre(0.0, 5000.0, 10000.0, 15000.0, 20000.0));
  EXPECT_THAT(round_ticks(0.97, 1.03),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.97, 0.98, 0.99, 1.0, 1.01, 1.02, 1.03}));
  for (const auto& [low, high] : {std::pair{-3.7, 11.2}, {1e-9, 7.3e-9}, {-5e12, -1e12}, {0.0, 0.9}}) {
    const std::vector<double> ticks = round_ticks(low, high);
    EXPECT_GE(ticks.size(), 4u);
    EXPECT_LE(ticks.size(), 9u);
    for (double tick : ticks) {
      EXPECT_GE(tick, low - 1e-6 * (high - low));
      EXPECT_LE(tick, high + 1e-6 * (high - low));
    }
  }
}

TEST(ColorBar, HasTheMapsColoursFromTheBottomToTheTop) {
  for (const char* name : {"viridis", "coolwarm"}) {
    const ColorBar bar = stress_bar(name);
    Image image = plain(640, 480, 0);
    ColorBarOverlay(bar, 640, 480).draw(image);
    // A column through the bar, from above: the panel, the pointed end, 240 rows of colours, the panel.
    int column = 0;
    for (int x = 639; x > 0 && column == 0; --x)
      if (pixel(image, x, 240)[0] > 150 && pixel(image, x - 1, 240)[0] == 0) column = x + 14;
    ASSERT_GT(column, 400);
    int first = 0;
    while (first < 480 && std::abs(pixel(image, column, first)[0] - bar.scale.map->above[0]) +
                                  std::abs(pixel(image, column, first)[1] - bar.scale.map->above[1]) +
                                  std::abs(pixel(image, column, first)[2] - bar.scale.map->above[2]) >
                              6)
      ++first;
    ASSERT_LT(first, 240) << "the end for values above";
    while (first < 480 && std::abs(pixel(image, column, first)[1] - bar.scale.map->above[1]) <= 6) ++first;
    for (int row = 2; row < 238; ++row) {
      const Rgb expected = bar.scale.color(20000.0 * (1.0 - (row + 0.5) / 240.0));
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(pixel(image, column, first + row)[c], expected[c], 3) << name << " row " << row;
    }
  }
}

TEST(ColorBar, IsReadableBeforeBlackAndWhiteAndLeavesTheRestAlone) {
  for (int grey : {0, 255}) {
    Image image = plain(640, 480, static_cast<std::uint8_t>(grey));
    ColorBarOverlay(stress_bar(), 640, 480).draw(image);
    int darkest = 255, brightest = 0, touched = 0;
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 640; ++x) {
        if (x < 500) {
          EXPECT_EQ(pixel(image, x, y)[0], grey);
        }
        if (pixel(image, x, y)[0] == grey && grey == 0) continue;
        const auto p = pixel(image, x, y);
        ++touched;
        darkest = std::min(darkest, std::max({p[0], p[1], p[2]}));
        brightest = std::max(brightest, std::min({p[0], p[1], p[2]}));
      }
    EXPECT_GT(touched, 10000);
    EXPECT_LT(darkest, 60) << "the ink";
    EXPECT_GT(brightest, 190) << "the panel";
  }
}

TEST(ColorBar, AddsToTheAlphaOfATransparentFrame) {
  Image image = plain(640, 480, 77, 0);
  ColorBarOverlay(stress_bar(), 640, 480).draw(image);
  const auto outside = pixel(image, 10, 10), panel = pixel(image, 640 - 11 - 3, 240);
  EXPECT_EQ(outside[3], 0);
  EXPECT_EQ(outside[0], 77);
  EXPECT_NEAR(panel[3], 0.8 * 255, 2);
  EXPECT_NEAR(panel[0], 255, 1) << "white, not mixed with what nobody sees";
}

TEST(ColorBar, AFrameSmallerThanItCutsIt) {
  Image image = plain(40, 30, 0);
  ColorBarOverlay(stress_bar(), 40, 30).draw(image);
  EXPECT_GT(brightness(image, 20, 15), 0);
  EXPECT_THROW(ColorBarOverlay(stress_bar(), 40, 31).draw(image), std::invalid_argument);
}

TEST(ColorBar, IsWrittenAsVectors) {
  Folder folder("color_bar");
  write_color_bar(folder / "colorbar.svg", stress_bar());
  EXPECT_THAT(folder.files(), testing::ElementsAre("colorbar.svg"));
  std::ifstream stream(folder / "colorbar.svg");
  std::ostringstream text;
  text << stream.rdbuf();
  EXPECT_THAT(text.str(), testing::HasSubstr("<svg"));
  EXPECT_THAT(text.str(), testing::HasSubstr("<linearGradient"));
  EXPECT_THAT(text.str(), testing::Not(testing::HasSubstr("<image"))) << "nothing in pixels";
  EXPECT_THAT(text.str(), testing::HasSubstr("<use")) << "letters as outlines";
  EXPECT_THAT([&] { write_color_bar(folder / "none/bar.svg", stress_bar()); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("none/bar.svg")));
}

}  // namespace
}  // namespace deforma
