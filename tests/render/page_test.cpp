#include "render/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "picture.hpp"

namespace deforma {
namespace {

/// Every pixel another colour, so that none can be mistaken.
Image pattern(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int value : {3 * x % 256, 5 * y % 256, (x + y) % 256, 255})
        image.rgba.push_back(static_cast<std::uint8_t>(value));
  return image;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return value;
}

TEST(Page, APngHasTheSizeItSaysAndThePicturesPixelForPixel) {
  Folder folder("page");
  const Image picture = pattern(100, 60);
  // 254 dots per inch: 10 per mm.
  const Page page{25.0, 8.0, {{picture, 1.0, 1.0, 10.0, "", ""}, {picture, 13.0, 1.0, 10.0, "", ""}}, {}};
  write_page_png(folder / "page.png", page, 254.0);
  const Image image = read_png(folder / "page.png");
  EXPECT_EQ(image.width, 250);
  EXPECT_EQ(image.height, 80);
  for (int left : {10, 130})
    for (int y = 0; y < 60; y += 7)
      for (int x = 0; x < 100; x += 7)
        ASSERT_EQ(pixel(image, left + x, 10 + y), pixel(picture, x, y)) << x << " " << y;
  EXPECT_EQ(pixel(image, 5, 5), (std::array<int, 4>{255, 255, 255, 255}));
  const std::string bytes = text_of(folder / "page.png");
  const std::size_t chunk = bytes.find("pHYs");
  ASSERT_NE(chunk, bytes.npos);
  EXPECT_EQ(big_endian(bytes, chunk + 4), 10000u) << "dots per metre";
  EXPECT_EQ(big_endian(bytes, chunk + 8), 10000u);
  EXPECT_EQ(bytes[chunk + 12], 1);
}

TEST(Page, LettersAndTheBarAreVectors) {
  Folder folder("page_vectors");
  const ColorBar bar{{&find_color_map("viridis"), 0.0, 3e4}, "von Mises stress", "Pa", false};
  const Page page{80.0, 40.0, {{pattern(50, 30), 0.0, 0.0, 50.0, "(a)", "0.40 s"}}, bar};
  for (const char* name : {"page.pdf", "page.svg"}) write_page_vectors(folder / name, page);
  EXPECT_THAT(folder.files(), testing::ElementsAre("page.pdf", "page.svg"));
  const std::string pdf = text_of(folder / "page.pdf"), svg = text_of(folder / "page.svg");
  EXPECT_THAT(pdf, testing::StartsWith("%PDF"));
  EXPECT_THAT(pdf, testing::HasSubstr("/Font"));
  EXPECT_THAT(svg, testing::HasSubstr("width=\"226.77"));
  EXPECT_THAT(svg, testing::HasSubstr("<linearGradient"));
  std::size_t images = 0;
  for (std::size_t at = svg.find("<image"); at != svg.npos; at = svg.find("<image", at + 1)) ++images;
  EXPECT_EQ(images, 1u) << "the picture alone";
}

TEST(Page, TheBarFitsBesideThePictures) {
  Folder folder("page_bar");
  const ColorBar bar{{&find_color_map("viridis"), 0.0, 3e4}, "strain energy density", "J/m³", false};
  const auto [width, height] = page_bar_size(bar);
  EXPECT_GT(width, 8.0);
  EXPECT_LT(width, 25.0);
  const Page page{width + 20.0, height, {{pattern(20, 10), 0.0, 0.0, 20.0, "", ""}}, bar};
  write_page_png(folder / "bar.png", page, 254.0);
  const Image image = read_png(folder / "bar.png");
  int inked = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const bool edge = y == 0 || y == image.height - 1 || x == image.width - 1;
      const bool dark = x >= 200 && brightness(image, x, y) < 200;
      EXPECT_FALSE(edge && dark) << "cut at " << x << " " << y;
      inked += dark;
    }
  EXPECT_GT(inked, 300);
}

TEST(Page, CropsToWholePixels) {
  const Image image = pattern(100, 60);
  const Image part = cropped(image, 0.25, 0.5, 0.75, 1.0);
  EXPECT_EQ(part.width, 50);
  EXPECT_EQ(part.height, 30);
  EXPECT_EQ(pixel(part, 0, 0), pixel(image, 25, 30));
  EXPECT_EQ(pixel(part, 49, 29), pixel(image, 74, 59));
  EXPECT_THROW(cropped(image, 0.5, 0.0, 0.5, 1.0), std::invalid_argument);
  EXPECT_THROW(cropped(image, 0.5, 0.0, 1.2, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace deforma
