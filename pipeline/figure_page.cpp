#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "pipeline/build.hpp"
#include "pipeline/figure.hpp"
#include "pipeline/framing.hpp"
#include "pipeline/user_error.hpp"

namespace deforma {

namespace {

/// A row's scene with what its pictures show.
struct Shown {
  World world;
  std::vector<Snapshot> snapshots;
};

/// Steps from frame to frame, as a run does, so that the figure shows what the animation shows.
void advance_to(Solver& solver, double time, double frame) {
  while (solver.state().time + frame <= time * (1.0 + 1e-9)) solver.advance(frame);
  if (time > solver.state().time * (1.0 + 1e-9)) solver.advance(time - solver.state().time);
}

Shown show(FigureRow& row) {
  Shown shown{build(row.scene), {}};
  frame_scene(row.scene, shown.world.solver->state());
  for (const double time : row.times) {
    advance_to(*shown.world.solver, time, 1.0 / row.scene.fps);
    shown.snapshots.push_back(take_snapshot(row.scene, *shown.world.solver, 1));
    shown.snapshots.back().time = time;
  }
  return shown;
}

double height_of(const FigureRow& row, double width) {
  const auto& [left, top, right, bottom] = row.crop;
  const OutputSpec& output = row.scene.output;
  return width * (bottom - top) * output.height / ((right - left) * output.width);
}

/// Draws the row's pictures, each with as many pixels as its width on the page has dots.
/// @param width of one picture [mm]
std::vector<Image> draw(FigureRow& row, const Shown& shown, const std::optional<Coloring>& coloring,
                        double width, double dpi, const std::string& platform) {
  const auto& [left, top, right, bottom] = row.crop;
  OutputSpec& output = row.scene.output;
  const double aspect = static_cast<double>(output.height) / output.width;
  output.width = static_cast<int>(std::lround(width * dpi / 25.4 / (right - left)));
  output.height = static_cast<int>(std::lround(output.width * aspect));
  std::optional<Renderer> renderer;
  try {
    renderer.emplace(renderer_settings(row.scene), ContextRequest{platform});
  } catch (const std::invalid_argument& error) {
    throw UserError(fmt::format("{}: {}", row.scene.name, error.what()));
  }
  Drawing drawing(row.scene, shown.world.solver->state());
  if (coloring) drawing.color_by(coloring->scale);
  std::vector<Image> images;
  for (const Snapshot& snapshot : shown.snapshots)
    images.push_back(cropped(renderer->draw(drawing.content(snapshot)), left, top, right, bottom));
  return images;
}

/// "(a)", ..., "(z)", "(aa)", ...
std::string label(int number) {
  std::string letters;
  for (int n = number + 1; n > 0; n = (n - 1) / 26)
    letters.insert(letters.begin(), static_cast<char>('a' + (n - 1) % 26));
  return "(" + letters + ")";
}

}  // namespace

Page make_page(Figure figure, const std::string& platform) {
  std::optional<Coloring> coloring = Coloring::of(figure.rows.front().scene);
  std::vector<Shown> shown;
  for (FigureRow& row : figure.rows) {
    shown.push_back(show(row));
    if (!coloring) continue;
    for (const Snapshot& snapshot : shown.back().snapshots)
      coloring->add(row.scene, shown.back().world.solver->state(), snapshot);
  }
  Page page{figure.width, 0.0, {}, {}};
  double bar_width = 0.0;
  if (coloring) {
    coloring->settle();
    page.bar = coloring->bar();
    bar_width = page_bar_size(*page.bar)[0];
  }
  int number = 0;
  for (std::size_t r = 0; r < figure.rows.size(); ++r) {
    FigureRow& row = figure.rows[r];
    const auto columns = static_cast<double>(row.times.size());
    const double width = (figure.width - bar_width - figure.gap * (columns - 1.0)) / columns;
    if (!(width >= 5.0))
      throw UserError(
          fmt::format("{}: {} pictures beside each other leave {:.1f} mm for each; the figure needs more "
                      "than its 'width' of {} mm",
                      row.scene.name, row.times.size(), width, figure.width));
    const double height = height_of(row, width);
    std::vector<Image> images = draw(row, shown[r], coloring, width, figure.dpi, platform);
    if (r > 0) page.height += figure.gap;
    for (std::size_t k = 0; k < images.size(); ++k, ++number)
      page.pictures.push_back({std::move(images[k]), static_cast<double>(k) * (width + figure.gap),
                               page.height, width, figure.labels ? label(number) : "",
                               figure.stamps ? fmt::format("{:.2f} s", row.times[k]) : ""});
    page.height += height;
  }
  if (page.bar) page.height = std::max(page.height, page_bar_size(*page.bar)[1]);
  return page;
}

}  // namespace deforma
