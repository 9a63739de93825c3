#include <fmt/core.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "pipeline/commands.hpp"
#include "pipeline/interrupt.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scene_options.hpp"

namespace deforma {

namespace {

struct Options {
  SceneOptions scene;
  std::string folder;
  std::string frames;
  std::string platform = "auto";
  bool no_video = false;
  bool overwrite = false;
  bool quiet = false;
};

/// out/NAME, whatever the name holds.
std::filesystem::path default_folder(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return std::filesystem::path("out") / name;
}

int run(const Options& options) {
  Scene scene = options.scene.load();
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
  run_options.stop_requested = [&] { return interrupt.requested(); };

  std::optional<tbb::global_control> threads;
  if (options.scene.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(options.scene.threads));
  bool has_video = scene.output.video != "none";
  std::string video = "video." + scene.output.video;
  RunRecord record = run_scene(std::move(scene), run_options);

  if (!options.quiet)
    fmt::print("{} frame{} in {:.1f} s on {} ({}): {}\n", record.frames_written,
               record.frames_written == 1 ? "" : "s", record.seconds, record.context.renderer,
               record.context.platform, (run_options.folder / (has_video ? video : "frames")).string());
  if (record.ending == Ending::diverged) {
    fmt::print(stderr, "error: {}\nThe {} frames before that are kept.\n", record.ending_message,
               record.frames_written);
    return exit_diverged;
  }
  return record.ending == Ending::interrupted ? exit_interrupted : exit_ok;
}

}  // namespace

void add_run_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("run", "Simulate a scene and write its frames, video and report");
  options->scene.add_to(*command);
  command->add_option("-o,--output", options->folder, "Folder to write to; out/NAME by default")
      ->type_name("DIR");
  command->add_option("--frames", options->frames, "Write only these frames, counted from 1")
      ->type_name("A:B");
  command
      ->add_option("--platform", options->platform, "Where to draw: auto, device:N, surfaceless or default")
      ->type_name("PLATFORM");
  command->add_flag("--no-video", options->no_video, "Write the frames only");
  command->add_flag("--overwrite", options->overwrite,
                    "Replace the frames, video and report of an earlier run");
  command->add_flag("--quiet", options->quiet, "Say nothing but errors");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace deforma
