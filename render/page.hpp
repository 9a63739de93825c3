#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/color_bar.hpp"
#include "render/image.hpp"

namespace deforma {

/// A picture at its place on a page; its height follows from its width.
struct PagePicture {
  Image image;
  double left, top, width;  ///< [mm]
  std::string label;        ///< in the upper left corner, such as (a); may be empty
  std::string stamp;        ///< in the lower left corner; may be empty
};

/// A white page of pictures with a colour bar.
struct Page {
  double width, height;  ///< [mm]
  std::vector<PagePicture> pictures;
  std::optional<ColorBar> bar;  ///< at the right edge
};

/// What a colour bar takes of a page's width, and the least height of a page that has one [mm].
std::array<double, 2> page_bar_size(const ColorBar& bar);

/// The part of a picture between two corners, given as shares of its width and height.
/// @throws std::invalid_argument when nothing would be left.
Image cropped(const Image& image, double left, double top, double right, double bottom);

/// Writes a page as PNG, which tells its resolution (pHYs). A picture with as many pixels as its width has dots is not resampled.
/// @param text as of write_png
/// @throws std::runtime_error naming the file when it cannot be written; nothing is left behind.
void write_page_png(const std::filesystem::path& file, const Page& page, double dpi,
                    const std::vector<std::pair<std::string, std::string>>& text = {});

/// Writes a page as PDF or SVG, by the file's ending, with letters and colour bar as vectors. @throws as above.
void write_page_vectors(const std::filesystem::path& file, const Page& page);

}  // namespace deforma
