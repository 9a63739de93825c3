#include "render/color_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace deforma {
namespace {

using Knots = std::array<std::uint32_t, 33>;  // 0xRRGGBB, evenly spaced

constexpr Knots viridis = {0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453681, 0x424086,
                           0x3f4989, 0x3b528b, 0x375a8d, 0x33638d, 0x2f6a8e, 0x2c728e, 0x297a8e,
                           0x26818e, 0x23898e, 0x21908c, 0x1f988b, 0x1f9f88, 0x21a685, 0x28ae80,
                           0x31b57b, 0x3ebc74, 0x4cc26c, 0x5dc963, 0x6ece58, 0x82d34c, 0x96d83f,
                           0xabdc32, 0xc0df24, 0xd5e21a, 0xeae51a, 0xfde725};
constexpr Knots cividis = {0x00224e, 0x00285b, 0x002e6a, 0x043371, 0x1a386f, 0x273e6e, 0x32436d,
                           0x3b496c, 0x434e6c, 0x4b546c, 0x52596d, 0x5a5f6e, 0x61656f, 0x686a71,
                           0x6f7073, 0x757676, 0x7c7b78, 0x848179, 0x8b8778, 0x938d78, 0x9b9376,
                           0xa39a75, 0xaba072, 0xb3a670, 0xbbad6c, 0xc3b469, 0xccba64, 0xd4c15f,
                           0xddc958, 0xe6d051, 0xefd748, 0xf8df3c, 0xfee838};
constexpr Knots magma = {0x000004, 0x030311, 0x0a0822, 0x130d33, 0x1d1146, 0x28115a, 0x36106a,
                         0x430f76, 0x50127c, 0x5d177f, 0x691c81, 0x762181, 0x822681, 0x8f2a81,
                         0x9c2e7f, 0xa9327d, 0xb63779, 0xc33b75, 0xcf4170, 0xdb486a, 0xe65163,
                         0xee5c5e, 0xf5695c, 0xf9785d, 0xfb8761, 0xfd9668, 0xfea571, 0xfeb47b,
                         0xfec387, 0xfed194, 0xfde0a2, 0xfceeb0, 0xfcfdbf};
constexpr Knots coolwarm = {0x3b4cc0, 0x445acc, 0x4d68d7, 0x5775e1, 0x6282ea, 0x6c8ef1, 0x779af7,
                            0x82a5fb, 0x8db0fe, 0x98b9ff, 0xa3c2ff, 0xaec9fd, 0xb8d0f9, 0xc2d5f4,
                            0xccd9ee, 0xd5dbe6, 0xdddddd, 0xe5d8d1, 0xecd3c5, 0xf1ccb9, 0xf5c4ad,
                            0xf7bba0, 0xf7b194, 0xf7a687, 0xf49a7b, 0xf18d6f, 0xec7f63, 0xe57058,
                            0xde604d, 0xd55042, 0xcb3e38, 0xc0282f, 0xb40426};

Rgb rgb(std::uint32_t hex) {
  return {static_cast<std::uint8_t>(hex >> 16), static_cast<std::uint8_t>(hex >> 8 & 0xff),
          static_cast<std::uint8_t>(hex & 0xff)};
}

/// The colour at a place in [0, 1], between neighbours of an even table.
template <class Table, class Color>
Rgb between(const Table& table, double place, const Color& color) {
  const double x = place * static_cast<double>(table.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(x), table.size() - 2);
  const double share = x - static_cast<double>(k);
  const Rgb a = color(table[k]), b = color(table[k + 1]);
  Rgb mixed;
  for (std::size_t c = 0; c < 3; ++c)
    mixed[c] = static_cast<std::uint8_t>(std::lround((1.0 - share) * a[c] + share * b[c]));
  return mixed;
}

ColorMap make_map(std::string_view name, const Knots& knots, bool diverging, std::uint32_t below,
                  std::uint32_t above, std::uint32_t undefined) {
  ColorMap map{name, diverging, {}, rgb(below), rgb(above), rgb(undefined)};
  for (std::size_t i = 0; i < map.colors.size(); ++i)
    map.colors[i] = between(knots, static_cast<double>(i) / 255.0, rgb);
  return map;
}

}  // namespace

// The colours of their own are far from those of their map, and from each other, for the colour-blind, too.
std::span<const ColorMap> color_maps() {
  static const std::array<ColorMap, 4> maps = {
      make_map("viridis", viridis, false, 0xccffff, 0x9933ff, 0x333300),
      make_map("cividis", cividis, false, 0xccffff, 0x9933ff, 0x333300),
      make_map("magma", magma, false, 0x3300ff, 0x66ccff, 0xffff33),
      make_map("coolwarm", coolwarm, true, 0x000033, 0xffcc33, 0x3300ff),
  };
  return maps;
}

std::span<const std::string_view> color_map_names() {
  static const auto names = [] {
    std::array<std::string_view, 4> all;
    std::transform(color_maps().begin(), color_maps().end(), all.begin(),
                   [](const ColorMap& map) { return map.name; });
    return all;
  }();
  return names;
}

const ColorMap& find_color_map(std::string_view name) {
  for (const ColorMap& map : color_maps())
    if (map.name == name) return map;
  throw std::invalid_argument(
      fmt::format("unknown colour map '{}' (allowed: {})", name, fmt::join(color_map_names(), ", ")));
}

Rgb ColorScale::color(double value) const {
  const double at = place(value);
  if (std::isnan(at)) return map->undefined;
  if (at < -color_tolerance) return map->below;
  if (at > 1.0 + color_tolerance) return map->above;
  return between(map->colors, std::clamp(at, 0.0, 1.0), [](const Rgb& color) { return color; });
}

}  // namespace deforma
