#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/coloring.hpp"
#include "pipeline/scene.hpp"
#include "render/page.hpp"

namespace deforma {

/// A row of a figure: one scene at several times.
struct FigureRow {
  Scene scene;
  std::vector<double> times;                          ///< ascending [s]
  std::array<double, 4> crop = {0.0, 0.0, 1.0, 1.0};  ///< left, top, right, bottom, as shares of a frame
};

/// All that a figure's file says.
struct Figure {
  std::string name;
  double width = 170.0;  ///< [mm]
  double dpi = 300.0;
  double gap = 1.5;  ///< between pictures [mm]
  bool labels = true;
  bool stamps = true;
  std::vector<FigureRow> rows;
};

/// @throws UserError with file, line, key, what was found, what is allowed and the nearest valid name.
Figure load_figure(const std::filesystem::path& file);

/// Simulates every scene up to its last time and draws its frames, coloured, if by a field, with one range for all.
/// @param platform as in ContextRequest
Page make_page(Figure figure, const std::string& platform);

}  // namespace deforma
