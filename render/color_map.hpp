#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace deforma {

using Rgb = std::array<std::uint8_t, 3>;  ///< sRGB

/// Colours that stand for numbers, and three of its own for those that have none there.
struct ColorMap {
  std::string_view name;
  bool diverging;               ///< from a neutral middle to two sides
  std::array<Rgb, 256> colors;  ///< from the lowest to the highest
  Rgb below, above, undefined;  ///< outside the range; not a number
};

/// viridis and magma (S. van der Walt, N. Smith 2015, CC0), cividis (J. Nunez, C. Anderton, R. Renslow, PLoS ONE 13(7),
/// 2018, fit for the colour-blind), from their published tables; coolwarm (K. Moreland, Diverging Color Maps for
/// Scientific Visualization, 2009), whose own table of 33 colours it is. The first two are kept as 33 colours, too, off
/// by at most 2/255 between them, cividis by at most 6/255 near its dark end.
std::span<const ColorMap> color_maps();
std::span<const std::string_view> color_map_names();

/// @throws std::invalid_argument for a name that is no map; the message lists the names.
const ColorMap& find_color_map(std::string_view name);

/// A map with the values that its ends stand for.
struct ColorScale {
  const ColorMap* map = nullptr;
  double low = 0.0;
  double high = 1.0;  ///< above low

  /// 0 for the lowest, 1 for the highest.
  double place(double value) const { return (value - low) / (high - low); }
  /// The colour of a value, as it is drawn: outside means by more than half a step of the map's colours.
  Rgb color(double value) const;
};

/// How far outside the range a place may be that still counts as its end, so that rounding shows nowhere.
inline constexpr double color_tolerance = 0.5 / 255.0;

}  // namespace deforma
