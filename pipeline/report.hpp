#pragma once

#include <string>
#include <vector>

#include "pipeline/build.hpp"
#include "pipeline/frame_pipeline.hpp"
#include "pipeline/scene.hpp"
#include "render/context.hpp"
#include "render/renderer.hpp"
#include "sim/solver.hpp"

namespace deforma {

/// How a run ended.
enum class Ending { complete, interrupted, diverged };

/// What a run leaves to report; times are wall seconds.
struct RunRecord {
  Ending ending = Ending::complete;
  std::string ending_message;  ///< why, unless complete
  ContextFacts context;
  int frames_written = 0;
  double seconds = 0.0;  ///< the whole run
  double build_seconds = 0.0;
  double frames_seconds = 0.0;  ///< from the first frame's simulation to the last one's file
  double simulate_seconds = 0.0;
  double skin_seconds = 0.0;
  double simulate_wait = 0.0;  ///< for the drawing
  FramePipeline::Load drawing;
  double png_seconds = 0.0;
  double video_seconds = 0.0;
  double write_wait = 0.0;
  Ledger first, last;
};

/// report.json: versions, the resolved scene, and what the run did.
std::string make_report(const Scene& scene, const World& world, const RunRecord& record);

/// "deforma 0.1.0"
std::string version_text();

}  // namespace deforma
