#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include "pipeline/bench.hpp"
#include "pipeline/files.hpp"
#include "pipeline/run.hpp"
#include "pipeline/stopwatch.hpp"

namespace deforma {

namespace {

namespace fs = std::filesystem;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// An object of the paper, as a shipped scene, and what the paper took for it: seconds an iteration (its TPIS).
struct Object {
  const char* scene;
  double paper_iteration;
};

constexpr Object objects[] = {
    {"octahedron_in_box", 0.099}, {"ellipsoid_in_cylinder", unknown}, {"cylinder_in_cylinder", unknown}};

struct Simulated {
  std::size_t particles;
  double iteration;  // [s]
  double rate;       // frames simulated per second
};

Simulated simulate(const Scene& scene) {
  World world = build(scene);
  Stopwatch watch;
  for (int frame = 2; frame <= scene.frames(); ++frame) world.solver->advance(1.0 / scene.fps);
  const double seconds = watch.lap();
  return {world.solver->state().size(), seconds / static_cast<double>(world.solver->statistics().substeps),
          (scene.frames() - 1) / seconds};
}

/// Frames per second of a whole run, drawn, written and encoded; unknown where nothing can be drawn.
double drawn_rate(const Scene& scene) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("deforma-bench-{}", getpid());
  RunOptions options;
  options.folder = folder;
  options.overwrite = true;
  double rate = unknown;
  try {
    const RunRecord record = run_scene(scene, options);
    rate = record.frames_written / record.frames_seconds;
  } catch (const std::runtime_error&) {  // no OpenGL here: that is no reason to measure nothing
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return rate;
}

}  // namespace

BenchTable bench_paper(const BenchSettings& settings) {
  BenchTable table = {
      "paper",
      "The paper's table 3: time of one simulation iteration (TPIS) and frames per second (FPS)",
      {{"scene", "scene", 0},
       {"fit", "fit", 0},
       {"particles", "particles", 0},
       {"paper_tpis_seconds", "paper's\nTPIS [s]", 3},
       {"tpis_seconds", "TPIS\n[s]", 6},
       {"times_faster", "times\nfaster", 0},
       {"fps_simulated", "FPS,\nsimulated", 0},
       {"fps_drawn", "FPS, drawn\nand written", 1}},
      {},
      {"'-': not measured, or not known of the paper. 30 FPS is real time.",
       "Simulated on all threads; drawn at 1280x720, every frame a PNG file and part of a video."}};
  for (const Object& object : objects) {
    for (const char* fit : {"quadratic", "linear"}) {
      settings.tell(fmt::format("paper: {}, {} fit", object.scene, fit));
      Scene scene = load_scene(find_scene(object.scene),
                               {{"solver.gradient", fmt::format("\"{}\"", fit), "deforma bench"}});
      if (settings.quick) scene.duration = 0.5;
      const Simulated simulated = simulate(scene);
      const double drawn = settings.quick ? unknown : drawn_rate(scene);
      table.rows.push_back({std::string(object.scene), std::string(fit),
                            static_cast<double>(simulated.particles), object.paper_iteration,
                            simulated.iteration, object.paper_iteration / simulated.iteration, simulated.rate,
                            drawn});
    }
  }
  return table;
}

}  // namespace deforma
