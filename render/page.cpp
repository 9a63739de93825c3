#include "render/page.hpp"

#include <cairo-pdf.h>
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

constexpr double point = 72.0 / 25.4;                       // per mm
constexpr double font = 8.0;                                // of all lettering [points]
constexpr double inset = 4.0;                               // of lettering in a picture [points]
constexpr double shortest_bar = 50.0, longest_bar = 160.0;  // the colours alone [points]

/// A picture as cairo holds it: premultiplied 0xAARRGGBB.
struct Pixels {
  explicit Pixels(const Image& image) {
    words.reserve(image.rgba.size() / 4);
    for (std::size_t p = 0; p < image.rgba.size(); p += 4) {
      const std::uint32_t alpha = image.rgba[p + 3];
      std::uint32_t word = alpha << 24;
      for (std::size_t c = 0; c < 3; ++c)
        word |= (image.rgba[p + c] * alpha + 127) / 255 << (16 - 8 * static_cast<int>(c));
      words.push_back(word);
    }
    surface.reset(cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(words.data()),
                                                      CAIRO_FORMAT_ARGB32, image.width, image.height,
                                                      4 * image.width));
  }

  std::vector<std::uint32_t> words;
  CairoOwned<cairo_surface_t> surface;
};

/// A line of letters that stands out from any picture.
void letter(cairo_t* cairo, double x, double y, const std::string& text, bool bold) {
  if (text.empty()) return;
  set_lettering(cairo, font, bold);
  cairo_move_to(cairo, x, y);
  cairo_text_path(cairo, text.c_str());
  cairo_set_source_rgba(cairo, 1.0, 1.0, 1.0, 0.75);
  cairo_set_line_width(cairo, 2.0);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(cairo);
  cairo_move_to(cairo, x, y);
  cairo_set_source_rgb(cairo, ink[0] / 255.0, ink[1] / 255.0, ink[2] / 255.0);
  cairo_show_text(cairo, text.c_str());
}

/// Draws the page in points.
/// @param dots per point where pictures are laid on whole dots, not resampled; 0: nowhere
void draw_page(cairo_t* cairo, const Page& page, double dots) {
  cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
  cairo_paint(cairo);
  for (const PagePicture& picture : page.pictures) {
    const Pixels pixels(picture.image);
    const double left = picture.left * point, top = picture.top * point;
    const double scale = picture.width * point / picture.image.width;
    cairo_save(cairo);
    const bool as_it_is =
        dots > 0.0 && std::abs(scale * dots * picture.image.width - picture.image.width) < 1.0;
    if (as_it_is) {
      cairo_identity_matrix(cairo);
      cairo_translate(cairo, std::round(left * dots), std::round(top * dots));
    } else {
      cairo_translate(cairo, left, top);
      cairo_scale(cairo, scale, scale);
    }
    cairo_set_source_surface(cairo, pixels.surface.get(), 0.0, 0.0);
    cairo_pattern_set_filter(cairo_get_source(cairo), as_it_is ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_BEST);
    cairo_paint(cairo);
    cairo_restore(cairo);
    const double bottom = top + scale * picture.image.height;
    letter(cairo, left + inset, top + inset + 0.75 * font, picture.label, true);
    letter(cairo, left + inset, bottom - inset, picture.stamp, false);
  }
  if (page.bar) {
    const double bar_height = std::clamp(page.height * point - 3.6 * font, shortest_bar, longest_bar);
    const BarExtent extent = color_bar_extent(*page.bar, font, bar_height);
    cairo_translate(cairo, page.width * point - extent.width, 0.5 * (page.height * point - extent.height));
    draw_color_bar(cairo, *page.bar, font, bar_height, false);
  }
}

}  // namespace

std::array<double, 2> page_bar_size(const ColorBar& bar) {
  const BarExtent extent = color_bar_extent(bar, font, shortest_bar);
  return {extent.width / point, extent.height / point};
}

Image cropped(const Image& image, double left, double top, double right, double bottom) {
  const int x = static_cast<int>(std::lround(left * image.width));
  const int y = static_cast<int>(std::lround(top * image.height));
  Image part;
  part.width = static_cast<int>(std::lround(right * image.width)) - x;
  part.height = static_cast<int>(std::lround(bottom * image.height)) - y;
  if (x < 0 || y < 0 || part.width < 1 || part.height < 1 || x + part.width > image.width ||
      y + part.height > image.height)
    throw std::invalid_argument(
        fmt::format("from [{}, {}] to [{}, {}] there is no part of a picture of {} x {} pixels", left, top,
                    right, bottom, image.width, image.height));
  for (int row = 0; row < part.height; ++row) {
    const auto begin = image.rgba.begin() + 4 * (static_cast<std::ptrdiff_t>(y + row) * image.width + x);
    part.rgba.insert(part.rgba.end(), begin, begin + 4 * static_cast<std::ptrdiff_t>(part.width));
  }
  return part;
}

void write_page_png(const std::filesystem::path& file, const Page& page, double dpi,
                    const std::vector<std::pair<std::string, std::string>>& text) {
  Image image;
  image.width = static_cast<int>(std::lround(page.width * dpi / 25.4));
  image.height = static_cast<int>(std::lround(page.height * dpi / 25.4));
  const CairoOwned<cairo_surface_t> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
  const CairoOwned<cairo_t> cairo(cairo_create(surface.get()));
  cairo_scale(cairo.get(), dpi / 72.0, dpi / 72.0);
  draw_page(cairo.get(), page, dpi / 72.0);
  check_cairo(cairo_status(cairo.get()), file.string());
  cairo_surface_flush(surface.get());
  const unsigned char* const data = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  image.rgba.reserve(4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto word =
          reinterpret_cast<const std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride)[x];
      for (int shift : {16, 8, 0}) image.rgba.push_back(static_cast<std::uint8_t>(word >> shift & 0xff));
      image.rgba.push_back(255);
    }
  write_png(file, image, text, static_cast<int>(std::lround(dpi / 0.0254)));
}

void write_page_vectors(const std::filesystem::path& file, const Page& page) {
  TemporaryFile temporary(file);
  const double width = page.width * point, height = page.height * point;
  const CairoOwned<cairo_surface_t> surface(
      file.extension() == ".pdf" ? cairo_pdf_surface_create(temporary.path().c_str(), width, height)
                                 : cairo_svg_surface_create(temporary.path().c_str(), width, height));
  const CairoOwned<cairo_t> cairo(cairo_create(surface.get()));
  check_cairo(cairo_status(cairo.get()), file.string());
  draw_page(cairo.get(), page, 0.0);
  check_cairo(cairo_status(cairo.get()), file.string());
  cairo_surface_finish(surface.get());
  check_cairo(cairo_surface_status(surface.get()), file.string());
  temporary.rename();
}

}  // namespace deforma
