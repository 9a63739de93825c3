#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/image.hpp"

namespace deforma {

/// A picture of at most 256 colours.
struct IndexedImage {
  std::array<std::uint32_t, 256> palette = {};  ///< 0xAARRGGBB
  std::vector<std::uint8_t> indices;            ///< width * height, rows from the top
};

/// Finds the colours by median cut (Heckbert 1982), the box that holds most pixels times its extent cut first, and dithers by
/// a fixed 4 x 4 pattern, which, unlike error diffusion, holds still from frame to frame. Alpha is ignored.
IndexedImage index_colors(const Image& image);

}  // namespace deforma
