#include "render/color_bar.hpp"

#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "render/cairo_parts.hpp"
#include "render/temporary_file.hpp"

namespace deforma {
namespace {

/// What stands beside the bar: numbers in a unit that suits them.
struct Label {
  double value;
  std::string text;
};
struct Labels {
  std::string title;
  std::vector<Label> ticks;
};

Labels labels_of(const ColorBar& bar) {
  static constexpr const char* prefixes[] = {"n", "µ", "m", "", "k", "M", "G", "T"};
  const double largest = std::max(std::abs(bar.scale.low), std::abs(bar.scale.high));
  int thousands = 0;
  if (bar.unit != "1" && (largest < 0.1 || largest >= 1000.0))
    thousands = std::clamp(static_cast<int>(std::floor(std::log10(largest) / 3.0 + 1e-9)), -3, 4);
  const double factor = std::pow(1000.0, thousands);
  Labels labels{
      bar.unit == "1" ? bar.title : fmt::format("{} ({}{})", bar.title, prefixes[thousands + 3], bar.unit),
      {}};
  const std::vector<double> ticks = round_ticks(bar.scale.low, bar.scale.high);
  const double step = ticks.size() > 1 ? (ticks[1] - ticks[0]) / factor : 1.0;
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  const bool powers = largest / factor >= 1e5 || decimals > 5;  // out of reach of the prefixes
  for (const double tick : ticks) {
    const double shown = std::abs(tick / factor) < 1e-9 * step ? 0.0 : tick / factor;
    std::string text =
        powers ? fmt::format("{:.3g}", std::abs(shown)) : fmt::format("{:.{}f}", std::abs(shown), decimals);
    labels.ticks.push_back({tick, shown < 0.0 ? "−" + text : text});
  }
  return labels;
}

void set_color(cairo_t* cairo, const Rgb& color) {
  cairo_set_source_rgb(cairo, color[0] / 255.0, color[1] / 255.0, color[2] / 255.0);
}

/// The bar in a box of its own, all lengths in multiples of the font's size.
class BarDrawing {
 public:
  BarDrawing(const ColorBar& bar, double font, double bar_height)
      : bar_(bar), labels_(labels_of(bar)), font_(font), bar_height_(bar_height) {
    const CairoOwned<cairo_surface_t> surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
    const CairoOwned<cairo_t> cairo(cairo_create(surface.get()));
    set_lettering(cairo.get(), font_);
    for (const Label& tick : labels_.ticks) widest_ = std::max(widest_, advance(cairo.get(), tick.text));
    title_length_ = advance(cairo.get(), labels_.title);
    check_cairo(cairo_status(cairo.get()), "the colour bar");
  }

  double width() const { return title_x() + 1.1 * font_; }
  double height() const {
    const double ends = bottom() + (bar_.open_below ? end() : 0.0);
    return std::max(ends, 0.5 * (top() + bottom() + title_length_)) + margin();
  }

  void draw(cairo_t* cairo, bool panel) const {
    set_lettering(cairo, font_);
    if (panel) draw_panel(cairo);
    draw_map(cairo);
    for (const Label& tick : labels_.ticks) draw_tick(cairo, tick);
    cairo_save(cairo);
    cairo_move_to(cairo, title_x(), 0.5 * (top() + bottom()) + 0.5 * title_length_);
    cairo_rotate(cairo, -0.5 * M_PI);
    cairo_show_text(cairo, labels_.title.c_str());
    cairo_restore(cairo);
    check_cairo(cairo_status(cairo), "the colour bar");
  }

 private:
  // Whole numbers for a font of whole pixels, so that the bar's edges are sharp.
  double margin() const { return std::round(0.8 * font_); }
  double end() const { return 1.0 * font_; }  // of a pointed end
  double left() const { return margin(); }
  double right() const { return left() + std::round(1.2 * font_); }
  double top() const {
    return std::round(std::max(margin() + end(), margin() + 0.5 * (title_length_ - bar_height_)));
  }
  double bottom() const { return top() + bar_height_; }
  double text_x() const { return right() + 0.65 * font_; }
  double title_x() const { return text_x() + widest_ + 1.35 * font_; }
  double y_of(double value) const { return bottom() - bar_.scale.place(value) * bar_height_; }

  static double advance(cairo_t* cairo, const std::string& text) {
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text.c_str(), &extents);
    return extents.x_advance;
  }

  void draw_panel(cairo_t* cairo) const {
    const double r = 0.5 * font_, w = width(), h = height();
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, w - r, r, r, -0.5 * M_PI, 0.0);
    cairo_arc(cairo, w - r, h - r, r, 0.0, 0.5 * M_PI);
    cairo_arc(cairo, r, h - r, r, 0.5 * M_PI, M_PI);
    cairo_arc(cairo, r, r, r, M_PI, 1.5 * M_PI);
    cairo_close_path(cairo);
    cairo_set_source_rgba(cairo, 1.0, 1.0, 1.0, 0.8);
    cairo_fill(cairo);
  }

  void outline(cairo_t* cairo) const {
    const double middle = 0.5 * (left() + right());
    cairo_move_to(cairo, left(), bottom());
    cairo_line_to(cairo, left(), top());
    cairo_line_to(cairo, middle, top() - end());
    cairo_line_to(cairo, right(), top());
    cairo_line_to(cairo, right(), bottom());
    if (bar_.open_below) cairo_line_to(cairo, middle, bottom() + end());
    cairo_close_path(cairo);
  }

  void draw_map(cairo_t* cairo) const {
    cairo_save(cairo);
    outline(cairo);
    cairo_clip(cairo);
    const ColorMap& map = *bar_.scale.map;
    cairo_rectangle(cairo, left(), top() - end(), right() - left(), end());
    set_color(cairo, map.above);
    cairo_fill(cairo);
    cairo_rectangle(cairo, left(), bottom(), right() - left(), end());
    set_color(cairo, map.below);
    cairo_fill(cairo);
    const CairoOwned<cairo_pattern_t> colors(cairo_pattern_create_linear(0.0, bottom(), 0.0, top()));
    for (std::size_t k = 0; k < map.colors.size(); ++k)
      cairo_pattern_add_color_stop_rgb(colors.get(), static_cast<double>(k) / 255.0, map.colors[k][0] / 255.0,
                                       map.colors[k][1] / 255.0, map.colors[k][2] / 255.0);
    cairo_set_source(cairo, colors.get());
    cairo_rectangle(cairo, left(), top(), right() - left(), bar_height_);
    cairo_fill(cairo);
    cairo_restore(cairo);
    outline(cairo);
    set_color(cairo, ink);
    cairo_set_line_width(cairo, 0.06 * font_);
    cairo_stroke(cairo);
  }

  void draw_tick(cairo_t* cairo, const Label& tick) const {
    const double y = y_of(tick.value);
    set_color(cairo, ink);
    cairo_set_line_width(cairo, 0.09 * font_);
    cairo_move_to(cairo, right(), y);
    cairo_line_to(cairo, right() + 0.35 * font_, y);
    cairo_stroke(cairo);
    cairo_move_to(cairo, text_x(), y + 0.36 * font_);
    cairo_show_text(cairo, tick.text.c_str());
  }

  const ColorBar& bar_;
  Labels labels_;
  double font_, bar_height_;
  double widest_ = 0.0, title_length_ = 0.0;
};

}  // namespace

void check_cairo(cairo_status_t status, const std::string& what) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(fmt::format("{}: {}", what, cairo_status_to_string(status)));
}

void set_lettering(cairo_t* cairo, double size, bool bold) {
  const CairoOwned<cairo_font_options_t> options(cairo_font_options_create());
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_SLIGHT);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo, options.get());
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
}

BarExtent color_bar_extent(const ColorBar& bar, double font, double bar_height) {
  const BarDrawing drawing(bar, font, bar_height);
  return {drawing.width(), drawing.height()};
}

void draw_color_bar(cairo_t* cairo, const ColorBar& bar, double font, double bar_height, bool panel) {
  BarDrawing(bar, font, bar_height).draw(cairo, panel);
}

std::vector<double> round_ticks(double low, double high) {
  const double least = (high - low) / 8.0;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  double step = 10.0 * power;
  for (const double digit : {5.0, 2.0, 1.0})
    if (digit * power >= least * (1.0 - 1e-9)) step = digit * power;
  std::vector<double> ticks;
  const double first = std::ceil(low / step - 1e-6), last = std::floor(high / step + 1e-6);
  for (double k = first; k <= last; k += 1.0) ticks.push_back(k * step);
  return ticks;
}

ColorBarOverlay::ColorBarOverlay(const ColorBar& bar, int width, int height)
    : width_(width), height_(height) {
  const double font = std::max(10.0, std::round(height / 45.0));
  const BarDrawing drawing(bar, font, std::round(0.5 * height));
  panel_width_ = static_cast<int>(std::ceil(drawing.width()));
  panel_height_ = static_cast<int>(std::ceil(drawing.height()));
  left_ = width - panel_width_ - static_cast<int>(font);
  top_ = (height - panel_height_) / 2;
  pixels_.resize(static_cast<std::size_t>(panel_width_) * static_cast<std::size_t>(panel_height_));
  const CairoOwned<cairo_surface_t> surface(cairo_image_surface_create_for_data(
      reinterpret_cast<unsigned char*>(pixels_.data()), CAIRO_FORMAT_ARGB32, panel_width_, panel_height_,
      4 * panel_width_));
  const CairoOwned<cairo_t> cairo(cairo_create(surface.get()));
  drawing.draw(cairo.get(), true);
  cairo_surface_finish(surface.get());
  check_cairo(cairo_surface_status(surface.get()), "the colour bar");
}

void ColorBarOverlay::draw(Image& image) const {
  if (image.width != width_ || image.height != height_)
    throw std::invalid_argument(fmt::format("a colour bar for {} x {} pixels on a picture of {} x {}", width_,
                                            height_, image.width, image.height));
  const int right = std::min(left_ + panel_width_, width_), bottom = std::min(top_ + panel_height_, height_);
  for (int y = std::max(top_, 0); y < bottom; ++y)
    for (int x = std::max(left_, 0); x < right; ++x) {
      const std::uint32_t over = pixels_[static_cast<std::size_t>((y - top_) * panel_width_ + x - left_)];
      const std::uint32_t covered = over >> 24;
      if (covered == 0) continue;
      std::uint8_t* const under = &image.rgba[4 * static_cast<std::size_t>(y * width_ + x)];
      // Straight alpha below, premultiplied above.
      const std::uint32_t seen = under[3] * (255 - covered);
      const std::uint32_t alpha = 255 * covered + seen;
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t own = over >> (16 - 8 * c) & 0xff;
        under[c] = static_cast<std::uint8_t>((255 * 255 * own + seen * under[c] + alpha / 2) / alpha);
      }
      under[3] = static_cast<std::uint8_t>((alpha + 127) / 255);
    }
}

void write_color_bar(const std::filesystem::path& file, const ColorBar& bar) {
  constexpr double point = 72.0 / 25.4;  // per mm
  const BarDrawing drawing(bar, 9.0, 46.0 * point);
  TemporaryFile temporary(file);
  const CairoOwned<cairo_surface_t> surface(
      cairo_svg_surface_create(temporary.path().c_str(), drawing.width(), drawing.height()));
  const CairoOwned<cairo_t> cairo(cairo_create(surface.get()));
  check_cairo(cairo_status(cairo.get()), file.string());
  drawing.draw(cairo.get(), false);
  cairo_surface_finish(surface.get());
  check_cairo(cairo_surface_status(surface.get()), file.string());
  temporary.rename();
}

}  // namespace deforma
