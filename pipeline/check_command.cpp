#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "pipeline/build.hpp"
#include "pipeline/commands.hpp"
#include "pipeline/framing.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/thread_count.hpp"

namespace deforma {

namespace {

/// How long the solver is tried for to say how long the run will take [s].
constexpr double trial_seconds = 0.5;

void print_bodies(const World& world) {
  fmt::print("\n{:<20} {:>10} {:>10} {:>10} {:>12} {:>12} {:>12}\n", "body", "particles", "vertices",
             "triangles", "mass [kg]", "volume [m3]", "spacing [m]");
  for (const BodyFacts& b : world.bodies)
    fmt::print("{:<20} {:>10} {:>10} {:>10} {:>12.5g} {:>12.5g} {:>12.4g}\n", b.name, b.particles, b.vertices,
               b.triangles, b.mass, b.volume, b.spacing);
}

void print_neighbors(const State& state) {
  std::size_t least = state.size() ? state.links.row(0).size() : 0, most = 0, all = 0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    std::size_t count = state.links.row(i).size();
    least = std::min(least, count);
    most = std::max(most, count);
    all += count;
  }
  fmt::print("neighbours       {:.1f} per particle ({} to {})\n",
             static_cast<double>(all) / static_cast<double>(state.size()), least, most);
}

std::string duration_text(double seconds) {
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  if (seconds < 3600) return fmt::format("{:.1f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

/// Runs the scene for a moment and prints what that says of the whole.
void try_out(const Scene& scene, Solver& solver) {
  double frame = 1.0 / scene.fps;
  double step = std::min(solver.stable_step(), frame);
  double substeps = std::ceil(frame / step);
  fmt::print("time step        {:.3g} s at the start\n", step);
  fmt::print("substeps         {:.0f} per frame, {} frames\n", substeps, scene.frames());
  fmt::print("memory           {:.1f} MB for particles, links, surface and effects\n",
             static_cast<double>(solver.statistics().bytes()) / 1e6);
  Stopwatch watch;
  double spent = 0.0;
  double simulated = 0.0;
  while (spent < trial_seconds && simulated < scene.duration) {
    solver.advance(step);
    simulated += step;
    spent += watch.lap();
  }
  fmt::print("expected time    {} for the simulation, by {} substeps tried; drawing goes on beside it\n",
             duration_text(spent / simulated * scene.duration), solver.statistics().substeps);
}

void look_over(Scene scene) {
  World world = build(scene);
  frame_scene(scene, world.solver->state());
  fmt::print("{}: {} s at {} frames per second, {}x{}\n", scene.name, scene.duration, scene.fps,
             scene.output.width, scene.output.height);
  print_bodies(world);
  fmt::print("\n");
  std::vector<std::string> effects, obstacles;
  for (const auto& effect : world.solver->effects()) effects.emplace_back(effect->name());
  for (const Obstacle& obstacle : world.solver->state().obstacles) obstacles.push_back(obstacle.name);
  fmt::print("effects          {}\n", effects.empty() ? "none" : fmt::to_string(fmt::join(effects, ", ")));
  fmt::print("obstacles        {}\n",
             obstacles.empty() ? "none" : fmt::to_string(fmt::join(obstacles, ", ")));
  print_neighbors(world.solver->state());
  for (const std::string& warning : world.warnings) fmt::print(stderr, "warning: {}\n", warning);
  try_out(scene, *world.solver);
}

}  // namespace

int check(const SceneOptions& options) {
  on_threads(options.threads, [&] { look_over(options.load()); });
  return exit_ok;
}

}  // namespace deforma
