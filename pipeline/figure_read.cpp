#include <fmt/core.h>

#include <algorithm>

#include "pipeline/figure.hpp"
#include "pipeline/files.hpp"
#include "pipeline/scene_keys.hpp"
#include "pipeline/table_reader.hpp"
#include "pipeline/toml_text.hpp"

namespace deforma {

namespace {

/// The colouring that all scenes of the figure share, whatever they say themselves.
struct FigureColors {
  std::string color_by = "none", color_map = "automatic";
  std::optional<std::array<double, 2>> color_range;
};

std::vector<double> read_numbers(const toml::node& node, const std::string& path, std::string_view form) {
  const toml::array* array = node.as_array();
  if (!array || array->empty())
    fail(node, path, fmt::format("expected {}, found {}", form, found_text(node)));
  std::vector<double> numbers;
  for (const toml::node& element : *array) numbers.push_back(read_number(element, path));
  return numbers;
}

std::filesystem::path find_row_scene(const toml::node& node, const std::string& path,
                                     const std::filesystem::path& figure) {
  const std::string name = read_text(node, path);
  std::error_code ignored;
  const std::filesystem::path beside = figure.parent_path() / name;
  if (std::filesystem::is_regular_file(beside, ignored)) return beside;
  try {
    return find_scene(name);
  } catch (const UserError& error) {
    fail(node, path, error.what());
  }
}

FigureRow read_row(const toml::table& table, const std::filesystem::path& file, const FigureColors& colors) {
  FigureRow row;
  TableReader reader(table, "row");
  reader.require("scene", "a file, or the name of a shipped scene");
  reader.require("times", "a list, s");
  const toml::node* scene = reader.take("scene");
  const toml::node* times = reader.take("times");
  const toml::node* crop = reader.take("crop");
  reader.finish();
  row.scene = load_scene(find_row_scene(*scene, "row.scene", file));
  row.scene.output.color_by = colors.color_by;
  row.scene.output.color_map = colors.color_map;
  row.scene.output.color_range = colors.color_range;
  row.times = read_numbers(*times, "row.times", "a list of times in s");
  for (std::size_t k = 0; k < row.times.size(); ++k)
    if (!(row.times[k] >= 0.0 && row.times[k] <= row.scene.duration) ||
        (k > 0 && row.times[k] <= row.times[k - 1]))
      fail(*times, "row.times",
           fmt::format("expected ascending times in [0, {}], found {}", row.scene.duration,
                       found_text(*times)));
  if (!crop) return row;
  const std::vector<double> sides =
      read_numbers(*crop, "row.crop", "four numbers [left, top, right, bottom]");
  const bool valid = sides.size() == 4 && sides[0] >= 0.0 && sides[1] >= 0.0 && sides[0] + 0.01 <= sides[2] &&
                     sides[1] + 0.01 <= sides[3] && sides[2] <= 1.0 && sides[3] <= 1.0;
  if (!valid)
    fail(*crop, "row.crop",
         fmt::format(
             "expected four numbers [left, top, right, bottom] in [0, 1], left below right and top below "
             "bottom, found {}",
             found_text(*crop)));
  std::copy(sides.begin(), sides.end(), row.crop.begin());
  return row;
}

}  // namespace

Figure load_figure(const std::filesystem::path& file) {
  const toml::table root = parse_toml_file(file);
  Figure figure;
  figure.name = file.stem().string();
  FigureColors colors;
  TableReader reader(root, "");
  reader.value("name", figure.name);
  reader.value("width", figure.width, Interval::closed(10.0, 2000.0));
  reader.value("dpi", figure.dpi, Interval::closed(20.0, 2400.0));
  reader.value("gap", figure.gap, Interval::closed(0.0, 50.0));
  reader.value("labels", figure.labels);
  reader.value("stamps", figure.stamps);
  reader.choice("color_by", colors.color_by, choices_after("none", field_names()));
  reader.choice("color_map", colors.color_map, choices_after("automatic", color_map_names()));
  reader.range("color_range", colors.color_range);
  const std::vector<const toml::table*> rows = reader.tables("row");
  reader.finish();
  if (rows.empty())
    throw UserError(fmt::format("{}: no [[row]]: a figure needs at least one", file.string()));
  for (const toml::table* row : rows) figure.rows.push_back(read_row(*row, file, colors));
  return figure;
}

}  // namespace deforma
