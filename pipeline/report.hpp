#pragma once

#include <string>
#include <vector>

#include "pipeline/build.hpp"
#include "pipeline/coloring.hpp"
#include "pipeline/scene.hpp"
#include "pipeline/stopwatch.hpp"
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
  double seconds = 0.0;         ///< the whole run
  double frames_seconds = 0.0;  ///< from the first frame's simulation to the last one's file
  Load build;                   ///< waits for the renderer
  Load simulate;                ///< waits for the drawing, which it may be only so far ahead of
  Load skin;                    ///< follows the simulation on its thread, so it never waits
  Load draw, png, video;
  DrawingCost drawing;  ///< of which `draw` is made up
  Antialiasing antialiasing;
  Ledger first, last;
  std::optional<Coloring> coloring;  ///< of bodies by a field
};

/// report.json: versions, the resolved scene, and what the run did.
std::string make_report(const Scene& scene, const World& world, const RunRecord& record);

/// "deforma 0.1.0"
std::string version_text();

/// Name and version of the libraries that the program was built with.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace deforma
