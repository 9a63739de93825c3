#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "pipeline/progress.hpp"
#include "pipeline/report.hpp"
#include "pipeline/scene.hpp"

namespace deforma {

/// Frames to write, counted from 1, both ends included.
struct FrameRange {
  int first;
  int last;
};

struct RunOptions {
  std::filesystem::path folder;
  std::optional<FrameRange> frames;  ///< all when absent
  bool overwrite = false;
  std::string platform = "auto";  ///< as in ContextRequest
  Progress::Style progress = Progress::Style::quiet;
  std::function<bool()> stop_requested;                  ///< asked between frames, may be empty
  std::function<void(const std::string&)> tell_warning;  ///< may be empty
};

/// Simulates the scene and writes its frames, video, report and resolved scene to the folder.
///
/// Frame 1 is the state at t = 0 and frame k that at (k-1)/fps. When the simulation diverges or is asked to
/// stop, every frame so far is kept and the video finished: the record says how it ended.
/// @throws UserError for what the user can mend, before anything is written; std::runtime_error for the
/// world's failures.
RunRecord run_scene(Scene scene, const RunOptions& options);

}  // namespace deforma
