#include "pipeline/run.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>

#include "pipeline/build.hpp"
#include "pipeline/coloring.hpp"
#include "pipeline/drawing.hpp"
#include "pipeline/encoding_keys.hpp"
#include "pipeline/frame_pipeline.hpp"
#include "pipeline/frame_text.hpp"
#include "pipeline/framing.hpp"
#include "pipeline/output_folder.hpp"
#include "pipeline/snapshot_store.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/user_error.hpp"
#include "render/sha256.hpp"
#include "render/video.hpp"

namespace deforma {

namespace {

ContextFacts wait_for_renderer(FramePipeline& pipeline) {
  try {
    return pipeline.ready();
  } catch (const std::invalid_argument& error) {
    throw UserError(error.what());
  }
}

std::optional<VideoWriter> open_video(const Scene& scene, const OutputFolder& folder) {
  if (scene.output.video == "none") return std::nullopt;
  try {
    return VideoWriter(folder.video_file(scene.output.video),
                       {scene.output.width, scene.output.height, scene.fps, encoding_request(scene.output)});
  } catch (const std::invalid_argument& error) {
    throw UserError(error.what());
  }
}

FrameRange frames_of(const Scene& scene, const RunOptions& options) {
  FrameRange range = options.frames.value_or(FrameRange{1, scene.frames()});
  if (range.first < 1 || range.last < range.first || range.last > scene.frames())
    throw UserError(
        fmt::format("frames {}:{} are outside the scene's 1:{}", range.first, range.last, scene.frames()));
  return range;
}

/// A particle whose deformation gradient has turned inside out can be stuck so, at a false equilibrium.
void warn_of_inversion(const State& state, double time, std::vector<std::string>& warnings) {
  std::vector<std::size_t> inverted(state.bodies.size(), 0);
  for (std::size_t i = 0; i < state.size(); ++i)
    if (state.fit.rank[i] == 3 && state.F[i].determinant() < 0.0) ++inverted[state.particles.body[i]];
  for (std::size_t b = 0; b < inverted.size(); ++b)
    if (inverted[b] > 0)
      warnings.push_back(
          fmt::format("'{}' ends, at {:.3g} s, with {} of its {} particles turned inside out: a "
                      "stiffer 'young', a 'volume' a larger 'poisson' or 'material' corotated may prevent it",
                      state.bodies[b].name, time, inverted[b], state.bodies[b].particles.size()));
}

/// Simulates up to the last frame and hands over those asked for.
void simulate(const Scene& scene, Solver& solver, const FrameRange& frames, const RunOptions& options,
              const std::function<void(Snapshot)>& hand_over, RunRecord& record) {
  Stopwatch watch;
  for (int frame = 1; frame <= frames.last; ++frame) {
    if (options.stop_requested && options.stop_requested()) {
      record.ending = Ending::interrupted;
      record.ending_message = fmt::format("stopped before frame {}", frame);
      return;
    }
    watch.lap();
    try {
      if (frame > 1) solver.advance(1.0 / scene.fps);
    } catch (const SimulationDiverged& error) {
      record.ending = Ending::diverged;
      record.ending_message = error.what();
      return;
    }
    record.simulate.busy += watch.lap();
    record.last = solver.ledger();
    if (frame < frames.first) continue;
    watch.lap();
    Snapshot snapshot = take_snapshot(scene, solver, frame);
    if (record.coloring) record.coloring->add(scene, solver.state(), snapshot);
    record.skin.busy += watch.lap();
    hand_over(std::move(snapshot));
    record.simulate.wait += watch.lap();
  }
}

/// Simulates all frames before the first is drawn, for what their colours mean is known only then.
void simulate_ahead(const Scene& scene, Solver& solver, const FrameRange& frames, const RunOptions& options,
                    const std::filesystem::path& folder, Progress& progress, RunRecord& record,
                    const std::function<void(Snapshot)>& hand_over) {
  SnapshotStore store(folder);
  progress.begin(frames.first, frames.last, "simulated frame");
  simulate(
      scene, solver, frames, options,
      [&](Snapshot snapshot) {
        store.push(snapshot);
        progress.frame_done(snapshot.frame);
      },
      record);
  progress.end();
  record.coloring->settle();
  progress.begin(frames.first, frames.last);
  Stopwatch watch;
  while (std::optional<Snapshot> snapshot = store.pop()) {
    // What an interrupted simulation has left is drawn; an interrupt that comes later ends the drawing.
    if (record.ending == Ending::complete && options.stop_requested && options.stop_requested()) {
      record.ending = Ending::interrupted;
      record.ending_message = fmt::format("stopped before frame {} was drawn", snapshot->frame);
      break;
    }
    hand_over(std::move(*snapshot));
  }
  record.simulate.wait += watch.lap();
}

}  // namespace

RunRecord run_scene(Scene scene, const RunOptions& options) {
  RunRecord record;
  Stopwatch whole, watch;
  FrameRange frames = frames_of(scene, options);
  record.coloring = Coloring::of(scene);
  OutputFolder folder(options.folder, options.overwrite);

  // The renderer starts up while the world is built.
  FramePipeline pipeline(renderer_settings(scene), {options.platform});
  World world = build(scene);
  frame_scene(scene, world.solver->state());
  Drawing drawing(scene, world.solver->state());
  record.build.busy = watch.lap();
  record.context = wait_for_renderer(pipeline);
  record.build.wait = watch.lap();
  for (const std::string& attempt : record.context.attempts)
    world.warnings.push_back(fmt::format("cannot draw on {}; '{}' draws on {}", attempt,
                                         record.context.platform, record.context.renderer));
  if (options.tell_warning)
    for (const std::string& warning : world.warnings) options.tell_warning(warning);

  folder.create();
  std::optional<VideoWriter> video = open_video(scene, folder);
  const std::string scene_text = scene_to_toml(scene);
  const std::string scene_hash = sha256(scene_text);
  write_text(folder.scene_file(), scene_text);
  Progress progress(options.progress);
  progress.begin(frames.first, frames.last);
  std::vector<FramePipeline::Write> writers = {[&](int frame, const Image& image) {
    write_png(folder.frame_file(frame), image, frame_text(scene, scene_hash, frame));
    folder.keep();  // a finished frame is worth keeping, whatever happens later
    ++record.frames_written;
    progress.frame_done(frame);
  }};
  if (video) writers.push_back([&](int, const Image& image) { video->add(image); });
  std::optional<ColorBarOverlay> color_bar;  // made before the first frame is handed over
  watch.lap();
  try {
    pipeline.start(
        [&](Renderer& renderer, const Snapshot& snapshot) {
          Image image = renderer.draw(drawing.content(snapshot));
          record.drawing = renderer.cost();
          record.antialiasing = renderer.antialiasing();
          if (color_bar) color_bar->draw(image);
          return image;
        },
        std::move(writers));
    record.first = world.solver->ledger();
    bool colors_known = !record.coloring;
    const auto hand_over = [&](Snapshot snapshot) {
      if (!colors_known) {
        drawing.color_by(record.coloring->scale);
        const ColorBar bar = record.coloring->bar();
        write_color_bar(folder.color_bar_file(), bar);
        if (scene.output.color_bar) color_bar.emplace(bar, scene.output.width, scene.output.height);
      }
      colors_known = true;
      pipeline.push(std::move(snapshot));
    };
    if (record.coloring && record.coloring->automatic)
      simulate_ahead(scene, *world.solver, frames, options, folder.path(), progress, record, hand_over);
    else
      simulate(scene, *world.solver, frames, options, hand_over, record);
    Stopwatch rest;
    pipeline.finish();
    record.simulate.wait += rest.lap();
  } catch (...) {
    pipeline.abandon();
    throw;
  }
  folder.keep();
  record.draw = pipeline.drawing();
  record.png = pipeline.writing(0);
  if (video) record.video = pipeline.writing(1);
  Stopwatch closing;
  if (video && record.frames_written > 0) video->close();
  record.video.busy += closing.lap();
  progress.end();
  const std::size_t told = world.warnings.size();
  warn_of_inversion(world.solver->state(), world.solver->state().time, world.warnings);
  if (options.tell_warning)
    for (std::size_t w = told; w < world.warnings.size(); ++w) options.tell_warning(world.warnings[w]);

  record.frames_seconds = watch.lap();
  record.seconds = whole.lap();
  write_text(folder.report_file(), make_report(scene, world, record));
  return record;
}

}  // namespace deforma
