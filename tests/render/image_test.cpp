#include "render/image.hpp"

#include <gmock/gmock.h>
#include <png.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "picture.hpp"

namespace deforma {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

Image colorful(int width, int height, bool opaque) {
  Image image{width, height, {}};
  std::uint32_t state = 1;
  for (int i = 0; i < width * height; ++i)
    for (int channel = 0; channel < 4; ++channel) {
      state = state * 1664525u + 1013904223u;
      image.rgba.push_back(channel == 3 && opaque ? 255 : static_cast<std::uint8_t>(state >> 24));
    }
  return image;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream input(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(input), {}};
}

TEST(Image, ComesBackAsWritten) {
  const Folder folder("image");
  for (const bool opaque : {true, false})
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {64, 33}}) {
      const Image image = colorful(width, height, opaque);
      write_png(folder / "a.png", image);
      const Image back = read_png(folder / "a.png");
      EXPECT_EQ(back.width, width);
      EXPECT_EQ(back.height, height);
      EXPECT_EQ(back.rgba, image.rgba);
    }
  EXPECT_THAT(folder.files(), ElementsAre("a.png"));
}

TEST(Image, WritesTheSameBytesTwiceAndCarriesText) {
  const Folder folder("image_text");
  write_png(folder / "a.png", colorful(20, 10, true), {{"Scene", "one"}, {"Frame", "12"}});
  write_png(folder / "b.png", colorful(20, 10, true), {{"Scene", "one"}, {"Frame", "12"}});
  EXPECT_EQ(bytes_of(folder / "a.png"), bytes_of(folder / "b.png"));
  EXPECT_THAT(bytes_of(folder / "a.png"), HasSubstr(std::string("tEXtScene\0one", 13)));
  EXPECT_THAT(bytes_of(folder / "a.png"), HasSubstr("sRGB"));
}

TEST(Image, CarriesTextBeyondAsciiAsUtf8) {
  const Folder folder("image_utf8");
  write_png(folder / "a.png", colorful(20, 10, true), {{"Title", "W\u00fcrfel"}});
  EXPECT_THAT(bytes_of(folder / "a.png"), HasSubstr(std::string("iTXtTitle\0\0\0\0\0W\u00fcrfel", 21)));
  EXPECT_EQ(read_png(folder / "a.png").rgba, colorful(20, 10, true).rgba);
}

TEST(Image, IsSmallerThanItsPixels) {
  const Folder folder("image_size");
  Image image{256, 256, {}};
  for (int i = 0; i < 256 * 256; ++i)
    for (const int level : {i / 256, i % 4 + 100, 60, 255})
      image.rgba.push_back(static_cast<std::uint8_t>(level));
  write_png(folder / "a.png", image);
  EXPECT_LT(std::filesystem::file_size(folder / "a.png"), 256u * 256u * 3u / 50u);
}

/// Writes by libpng itself, in kinds that write_png never makes. `rows` hold packed pixels.
void write_kind(const std::filesystem::path& file, int width, int height, int depth, int color,
                bool interlaced, std::vector<std::vector<std::uint8_t>> rows) {
  std::FILE* output = std::fopen(file.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, output);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), depth, color,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_color palette[2] = {{10, 20, 30}, {200, 100, 50}};
  png_byte alpha[1] = {128};
  if (color == PNG_COLOR_TYPE_PALETTE) {
    png_set_PLTE(png, info, palette, 2);
    png_set_tRNS(png, info, alpha, 1, nullptr);
  }
  std::vector<png_bytep> pointers;
  for (auto& row : rows) pointers.push_back(row.data());
  png_set_rows(png, info, pointers.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(output);
}

TEST(Image, ReadsEveryKindOfPng) {
  const Folder folder("image_kinds");
  write_kind(folder / "palette.png", 2, 1, 8, PNG_COLOR_TYPE_PALETTE, false, {{0, 1}});
  EXPECT_THAT(read_png(folder / "palette.png").rgba, ElementsAre(10, 20, 30, 128, 200, 100, 50, 255));
  write_kind(folder / "gray1.png", 2, 1, 1, PNG_COLOR_TYPE_GRAY, false, {{0b01000000}});
  EXPECT_THAT(read_png(folder / "gray1.png").rgba, ElementsAre(0, 0, 0, 255, 255, 255, 255, 255));
  write_kind(folder / "gray16.png", 1, 2, 16, PNG_COLOR_TYPE_GRAY_ALPHA, false,
             {{0x80, 0x80, 0xff, 0xff}, {0, 0, 0, 0}});
  EXPECT_THAT(read_png(folder / "gray16.png").rgba, ElementsAre(128, 128, 128, 255, 0, 0, 0, 0));
  write_kind(folder / "interlaced.png", 2, 2, 8, PNG_COLOR_TYPE_RGB, true,
             {{1, 2, 3, 4, 5, 6}, {7, 8, 9, 10, 11, 12}});
  EXPECT_THAT(read_png(folder / "interlaced.png").rgba,
              ElementsAre(1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 255));
}

TEST(Image, RefusesWhatIsNoPng) {
  const Folder folder("image_bad");
  const auto refuses = [&](const std::string& name, const char* why) {
    EXPECT_THAT([&] { read_png(folder / name); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(name), HasSubstr(why))));
  };
  refuses("missing.png", "No such file");
  std::ofstream(folder / "empty.png");
  refuses("empty.png", "not a PNG");
  std::ofstream(folder / "text.png") << "a mesh, perhaps";
  refuses("text.png", "not a PNG");
  write_png(folder / "whole.png", colorful(40, 40, true));
  const std::string whole = bytes_of(folder / "whole.png");
  for (const std::size_t length : {std::size_t{20}, std::size_t{60}, whole.size() / 2, whole.size() - 20}) {
    std::ofstream(folder / "cut.png", std::ios::binary) << whole.substr(0, length);
    refuses("cut.png", "damaged");
  }
}

TEST(Image, LeavesNothingWhenItCannotWrite) {
  const Folder folder("image_unwritable");
  EXPECT_THAT([&] { write_png(folder / "no/such/a.png", colorful(2, 2, true)); },
              ThrowsMessage<std::runtime_error>(HasSubstr("a.png")));
  // A folder in the place of the file: everything works until the renaming.
  std::filesystem::create_directory(folder / "taken.png");
  EXPECT_THAT([&] { write_png(folder / "taken.png", colorful(2, 2, true)); },
              ThrowsMessage<std::runtime_error>(HasSubstr("taken.png")));
  EXPECT_THAT(folder.files(), ElementsAre("taken.png"));
}

TEST(Image, RefusesPixelsThatDoNotFitTheSize) {
  const Folder folder("image_size");
  EXPECT_THAT(
      [&] {
        write_png(folder / "a.png", Image{3, 2, std::vector<std::uint8_t>(20)});
      },
      ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("3 x 2"), HasSubstr("20 bytes"))));
  EXPECT_THAT([&] { write_png(folder / "a.png", Image{}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("0 x 0")));
  EXPECT_THAT(
      [&] {
        write_png(folder / "a.png", colorful(1, 1, true), {{"", "value"}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("key")));
  EXPECT_THAT(folder.files(), IsEmpty());
}

}  // namespace
}  // namespace deforma
