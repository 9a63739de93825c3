#include <fmt/core.h>

#include <algorithm>
#include <csignal>

#include "pipeline/commands.hpp"
#include "pipeline/interrupt.hpp"
#include "pipeline/portable_process.hpp"
#include "pipeline/run.hpp"
#include "pipeline/thread_count.hpp"

namespace deforma {

namespace {

/// out/NAME, whatever the name holds.
std::filesystem::path default_folder(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return std::filesystem::path("out") / name;
}

}  // namespace

int run(const RunCommand& options) {
  Scene scene = options.scene.load();
  if (scene.solver.portable) compute_portably();
  if (options.no_video) scene.output.video = "none";

  RunOptions run_options;
  run_options.folder =
      options.folder.empty() ? default_folder(scene.name) : std::filesystem::path(options.folder);
  if (!options.frames.empty()) run_options.frames = parse_frames(options.frames, scene.frames());
  run_options.overwrite = options.overwrite;
  run_options.platform = options.platform;
  run_options.progress = Progress::style_for(options.quiet);
  if (!options.quiet)
    run_options.tell_warning = [](const std::string& warning) {
      fmt::print(stderr, "warning: {}\n", warning);
    };
  InterruptWatch interrupt;
  run_options.stop_requested = [&] { return interrupt.signal() != 0; };

  bool has_video = scene.output.video != "none";
  std::string video = "video." + scene.output.video;
  RunRecord record =
      on_threads(options.scene.threads, [&] { return run_scene(std::move(scene), run_options); });

  if (!options.quiet)
    fmt::print("{} frame{} in {:.1f} s on {} ({}): {}\n", record.frames_written,
               record.frames_written == 1 ? "" : "s", record.seconds, record.context.renderer,
               record.context.platform, (run_options.folder / (has_video ? video : "frames")).string());
  if (record.ending == Ending::diverged) {
    fmt::print(stderr, "error: {}\nThe {} frames before that are kept.\n", record.ending_message,
               record.frames_written);
    return exit_diverged;
  }
  if (record.ending == Ending::complete) return exit_ok;
  return interrupt.signal() == SIGTERM ? exit_terminated : exit_interrupted;
}

}  // namespace deforma
