#include "render/straight_alpha.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace deforma {
namespace {

double to_linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

double to_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

std::uint8_t to_byte(double share) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::min(share, 1.0)));
}

const std::array<double, 256>& linear_of_byte() {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> levels;
    for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = to_linear(static_cast<double>(i) / 255.0);
    return levels;
  }();
  return table;
}

void divide(std::uint8_t* pixel) {
  std::array<double, 3> light;
  for (std::size_t c = 0; c < 3; ++c) light[c] = linear_of_byte()[pixel[c]];
  const double alpha = std::max({pixel[3] / 255.0, light[0], light[1], light[2]});
  pixel[3] = to_byte(alpha);
  if (pixel[3] == 0) return;
  for (std::size_t c = 0; c < 3; ++c) pixel[c] = to_byte(to_srgb(light[c] / alpha));
}

/// One ring of pixels around what is covered or filled already.
void spread(Image& image, std::vector<std::uint8_t>& known) {
  std::vector<std::size_t> reached;
  const int w = image.width, h = image.height;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x);
      if (known[at]) continue;
      std::array<int, 3> sum = {};
      int count = 0;
      for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, h - 1); ++ny)
        for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, w - 1); ++nx) {
          const auto next =
              static_cast<std::size_t>(ny) * static_cast<std::size_t>(w) + static_cast<std::size_t>(nx);
          if (!known[next]) continue;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += image.rgba[4 * next + c];
          ++count;
        }
      if (count == 0) continue;
      for (std::size_t c = 0; c < 3; ++c)
        image.rgba[4 * at + c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
      reached.push_back(at);
    }
  for (const std::size_t at : reached) known[at] = 1;
}

}  // namespace

void make_straight(Image& image) {
  std::vector<std::uint8_t> known(image.rgba.size() / 4);
  for (std::size_t i = 0; i < known.size(); ++i) {
    std::uint8_t* pixel = image.rgba.data() + 4 * i;
    // Most pixels are one or the other, and stay as they are.
    if (pixel[3] != 255 && (pixel[0] | pixel[1] | pixel[2] | pixel[3]) != 0) divide(pixel);
    known[i] = pixel[3] != 0;
  }
  // As far as two pixels of chroma and the filter that makes them reach.
  for (int ring = 0; ring < 3; ++ring) spread(image, known);
}

}  // namespace deforma
