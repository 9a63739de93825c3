#include "render/image.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "render/temporary_file.hpp"

namespace deforma {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// libpng leaves by longjmp, over whatever lies between: so nothing with a destructor lives between setjmp
/// and the calls, and the reason waits here until it can be thrown.
struct Reason {
  std::string text;
};

void on_error(png_structp png, png_const_charp message) {
  static_cast<Reason*>(png_get_error_ptr(png))->text = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

bool encode(png_structp png, png_infop info, std::FILE* file, const Image& image, bool opaque,
            std::vector<png_text>& text, int dots_per_metre) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  // Measured on frames of cylinder_in_cylinder at 1280 x 720, CPU time of one core and size:
  //   libpng's default 106 ms 280 KiB; without filters level 1 13.0 ms 398 KiB, level 2 12.7 ms 318 KiB, level 3 14.0 ms
  //   276 KiB, level 4 17.6 ms 279 KiB, level 6 33.8 ms 202 KiB, level 9 98 ms 178 KiB; level 3 with the filter Sub 26 ms
  //   282 KiB, Up 39 ms 405 KiB, Paeth 40 ms 385 KiB.
  // A filter turns the even pattern of the dither into noise, and so costs both time and bytes. Level 3 is where another
  // millisecond stops to save tens of kilobytes.
  png_set_compression_level(png, 3);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (dots_per_metre > 0)
    png_set_pHYs(png, info, static_cast<png_uint_32>(dots_per_metre),
                 static_cast<png_uint_32>(dots_per_metre), PNG_RESOLUTION_METER);
  if (!text.empty()) png_set_text(png, info, text.data(), static_cast<int>(text.size()));
  png_write_info(png, info);
  if (opaque) png_set_filler(png, 0, PNG_FILLER_AFTER);  // each fourth byte is left out
  const std::size_t row = 4 * static_cast<std::size_t>(image.width);
  for (std::size_t start = 0; start < image.rgba.size(); start += row)
    png_write_row(png, image.rgba.data() + start);
  png_write_end(png, info);
  return std::fflush(file) == 0;
}

/// Asks libpng for 8-bit RGBA whatever the file holds.
bool decode_header(png_structp png, png_infop info, std::FILE* file) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  png_read_info(png, info);
  // Damaged sizes would ask for more memory than there is.
  if (static_cast<std::uint64_t>(png_get_image_width(png, info)) * png_get_image_height(png, info) >
      (1u << 28))
    png_error(png, "more than 2^28 pixels");
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xff, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool decode_rows(png_structp png, std::vector<png_bytep>& rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, rows.data());
  png_read_end(png, nullptr);
  return true;
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text, int dots_per_metre) {
  const auto expected = 4 * static_cast<std::size_t>(std::max(image.width, 0)) *
                        static_cast<std::size_t>(std::max(image.height, 0));
  if (expected == 0 || image.rgba.size() != expected)
    throw std::invalid_argument(fmt::format("cannot write '{}': a picture of {} x {} pixels with {} bytes",
                                            file.string(), image.width, image.height, image.rgba.size()));
  for (const auto& [key, value] : text)
    if (key.empty() || key.size() > 79)
      throw std::invalid_argument(fmt::format(
          "cannot write '{}': a text chunk's key has 1 to 79 characters, not '{}'", file.string(), key));

  bool opaque = true;
  for (std::size_t alpha = 3; alpha < image.rgba.size() && opaque; alpha += 4)
    opaque = image.rgba[alpha] == 255;
  std::vector<std::pair<std::string, std::string>> strings = text;
  std::vector<png_text> chunks;
  for (auto& [key, value] : strings) {
    png_text chunk = {};
    chunk.key = key.data();
    chunk.text = value.data();
    // A tEXt chunk is Latin-1: UTF-8 has a kind of its own.
    const bool ascii = std::all_of(value.begin(), value.end(), [](char c) { return (c & 0x80) == 0; });
    chunk.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    (ascii ? chunk.text_length : chunk.itxt_length) = value.size();
    chunks.push_back(chunk);
  }

  TemporaryFile temporary(file);
  File output(std::fopen(temporary.path().c_str(), "wb"), &std::fclose);
  if (!output)
    throw std::runtime_error(fmt::format("cannot write '{}': {}", file.string(), std::strerror(errno)));
  Reason reason;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &reason, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  errno = 0;
  const bool written = info && encode(png, info, output.get(), image, opaque, chunks, dots_per_metre);
  const int cause = errno;  // of libpng's plain "Write Error", too
  png_destroy_write_struct(&png, &info);
  const bool closed = std::fclose(output.release()) == 0;
  if (!written || !closed) {
    const int last = cause != 0 ? cause : errno;
    throw std::runtime_error(
        fmt::format("cannot write '{}': {}", file.string(),
                    last != 0 || reason.text.empty() ? std::strerror(last) : reason.text));
  }
  temporary.rename();
}

Image read_png(const std::filesystem::path& file) {
  File input(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!input)
    throw std::runtime_error(fmt::format("cannot read '{}': {}", file.string(), std::strerror(errno)));
  png_byte signature[8] = {};
  if (std::fread(signature, 1, sizeof signature, input.get()) != sizeof signature ||
      png_sig_cmp(signature, 0, sizeof signature) != 0)
    throw std::runtime_error(fmt::format("cannot read '{}': it is not a PNG file", file.string()));
  std::rewind(input.get());

  Reason reason;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reason, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  Image image;
  bool read = info && decode_header(png, info, input.get());
  if (read) {
    image.width = static_cast<int>(png_get_image_width(png, info));
    image.height = static_cast<int>(png_get_image_height(png, info));
    image.rgba.resize(4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    std::vector<png_bytep> rows(static_cast<std::size_t>(image.height));
    for (std::size_t y = 0; y < rows.size(); ++y)
      rows[y] = image.rgba.data() + 4 * y * static_cast<std::size_t>(image.width);
    read = decode_rows(png, rows);
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (!read)
    throw std::runtime_error(fmt::format("cannot read '{}': the PNG is damaged ({})", file.string(),
                                         reason.text.empty() ? "libpng cannot start" : reason.text));
  return image;
}

}  // namespace deforma
