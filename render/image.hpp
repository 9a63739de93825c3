#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace deforma {

/// 8-bit sRGB pixels with straight alpha, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 * width * height
};

/// Writes a PNG to a temporary name beside `file` and renames it, so that no half file is ever seen.
/// The same image and text give the same bytes. Opaque images are stored without their alpha.
/// @param text key (1 to 79 printable ASCII characters) and value (UTF-8); tEXt chunks, iTXt where a value needs more
///        than ASCII
/// @param dots_per_metre the resolution it is meant for (pHYs); 0: none
/// @throws std::runtime_error naming the file when it cannot be written; nothing is left behind.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {}, int dots_per_metre = 0);

/// @throws std::runtime_error naming the file when it is missing or not a readable PNG.
Image read_png(const std::filesystem::path& file);

}  // namespace deforma
