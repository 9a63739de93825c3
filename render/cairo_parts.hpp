#pragma once

#include <cairo.h>

#include <memory>
#include <string>

#include "render/color_bar.hpp"

/// What the files that draw with cairo share.
namespace deforma {

struct CairoRelease {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_pattern_t* pattern) const { cairo_pattern_destroy(pattern); }
  void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
template <class T>
using CairoOwned = std::unique_ptr<T, CairoRelease>;

/// @throws std::runtime_error naming `what`.
void check_cairo(cairo_status_t status, const std::string& what);

/// The font of all lettering, in the surface's units.
void set_lettering(cairo_t* cairo, double size, bool bold = false);

/// The ink of all lettering and lines.
inline constexpr Rgb ink = {24, 26, 30};

struct BarExtent {
  double width, height;
};

/// The size of a colour bar with all that belongs to it.
/// @param font       size of the letters, in the surface's units
/// @param bar_height of the colours alone
BarExtent color_bar_extent(const ColorBar& bar, double font, double bar_height);

/// Draws it with its upper left corner at the origin.
void draw_color_bar(cairo_t* cairo, const ColorBar& bar, double font, double bar_height, bool panel);

}  // namespace deforma
