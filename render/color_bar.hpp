#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "render/color_map.hpp"
#include "render/image.hpp"

namespace deforma {

/// The legend of a colour scale: the map with round numbers beside it, the name and the unit, and pointed ends in the
/// colours of what lies outside.
struct ColorBar {
  ColorScale scale;
  std::string title;
  std::string unit;        ///< SI, may get a prefix such as k; "1" for none
  bool open_below = true;  ///< whether anything can lie below the range
};

/// Round numbers inside the range: 1, 2 or 5 times a power of ten apart, four to eight of them, ascending.
std::vector<double> round_ticks(double low, double high);

/// A bar for frames of one size, drawn once and laid over each: at the right edge, on a pale panel that keeps it readable
/// before anything.
class ColorBarOverlay {
 public:
  /// @param width,height of the frames [pixels]
  /// @throws std::runtime_error when it cannot be drawn.
  ColorBarOverlay(const ColorBar& bar, int width, int height);

  /// @throws std::invalid_argument when the image has another size.
  void draw(Image& image) const;

 private:
  int width_, height_;  // of the frames
  int left_, top_;      // of the panel in them; may be outside of a small frame
  int panel_width_, panel_height_;
  std::vector<std::uint32_t> pixels_;  // premultiplied 0xAARRGGBB
};

/// Writes the bar alone as SVG, without a panel, 60 mm high.
/// @throws std::runtime_error naming the file when it cannot be written; nothing is left behind.
void write_color_bar(const std::filesystem::path& file, const ColorBar& bar);

}  // namespace deforma
