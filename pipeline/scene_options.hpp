#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/run.hpp"
#include "pipeline/scene.hpp"

namespace deforma {

/// The options with which `run` and `check` say which scene they mean.
struct SceneOptions {
  std::string scene;
  std::vector<std::string> sets;  ///< KEY=VALUE
  std::string size;               ///< WxH
  std::string view;
  std::string quality, color_by, color_map;
  std::string color_range;                              ///< LOW:HIGH
  std::string video, codec, preset, pixel_format, crf;  ///< as the keys of [output]
  int threads = 0;                                      ///< 0: all
  bool transparent = false;                             ///< whatever the scene says
  bool portable = false;                                ///< whatever the scene says

  /// @throws UserError as `load_scene`, and for an option that is not of its form.
  Scene load() const;
};

/// "A:B", "A", "A:" or ":B"; what is left out is the first or the last frame.
/// @throws UserError for anything else.
FrameRange parse_frames(const std::string& text, int last_frame);

}  // namespace deforma
