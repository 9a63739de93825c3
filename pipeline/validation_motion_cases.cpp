#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "pipeline/stopwatch.hpp"
#include "pipeline/validation_case.hpp"
#include "pipeline/validation_probe.hpp"

namespace deforma {

namespace {

ValidationCase dropped_beam() {
  BarSpec bar{.width = 0.25, .young = 5e6, .poisson = 0.33, .density = 1000.0, .duration = 1.2, .fps = 100.0};
  bar.world = "gravity = [0, 0, -9.81]\n";
  return {.name = "dropped-beam",
          .summary = "a clamped beam let go under its own weight; it swings for 1.2 s, without damping",
          .sizes = {4, 6, 8, 10},
          .small = false,
          .weight = 100.0,
          .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
          .mesh = {},
          .measure = [bar](const Scene& scene, World& world, const ValidationVariant& variant) -> Measured {
            Measured measured;
            std::vector<double> times, tip;
            double cpu = 0.0, lowest = 0.0;
            for (int frame = 0; frame <= scene.frames(); ++frame) {
              times.push_back(world.solver->state().time);
              tip.push_back(face_displacement(*world.solver, bar.length).z());
              lowest = std::min(lowest, tip.back());
              measured.largest_strain =
                  std::max(measured.largest_strain, largest_strain(world.solver->state()));
              ThreadStopwatch watch;
              if (frame < scene.frames()) world.solver->advance(1.0 / scene.fps);
              cpu += watch.lap();
            }
            const double guess = find_criterion("dropped-beam", "period").reference;
            const Oscillation swing = fit_oscillation(times, tip, guess);
            measured.values = {{"period", swing.period},
                               {"period (Timoshenko)", swing.period},
                               {"twice the mean sag", -2.0 * swing.mean},
                               {"twice the mean sag (Timoshenko)", -2.0 * swing.mean},
                               {"largest deflection", -lowest}};
            if (variant.n <= 6) measured.values.emplace_back("CPU for 1.2 s", cpu);
            return measured;
          }};
}

/// Half a sine as keyframes of a force along x.
std::string half_sine(double force, double duration) {
  constexpr int keys = 40;
  std::string text;
  for (int k = 0; k <= keys; ++k)
    text += fmt::format("{}[{}, [{}, 0, 0]]", k ? ", " : "", duration * k / keys,
                        k == keys ? 0.0 : force * std::sin(std::numbers::pi * k / keys));
  return "[" + text + "]";
}

ValidationCase wave() {
  BarSpec bar{.width = 0.1, .poisson = 0.0, .density = 1000.0, .clamped = false};
  const double passage = bar.length / std::sqrt(bar.young / bar.density);  // of the whole bar [s]
  const double pulse = 0.3 * passage;
  bar.body = fmt::format("load = {{ force = {}, region = {} }}\n",
                         half_sine(1e-4 * bar.young * bar.width * bar.width, pulse),
                         region_from(bar.length, bar.length));
  return {
      .name = "wave",
      .summary = "a pulse of traction at one end of a free bar, L/H = 10; the time from X = 0.7 to X = 0.3",
      .sizes = {4, 6, 8, 10},
      .small = true,
      .weight = 20.0,
      .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
      .mesh = {},
      .measure = [bar, passage](const Scene&, World& world, const ValidationVariant&) -> Measured {
        constexpr int samples = 300;
        const double end = 1.15 * passage;  // the pulse has passed X = 0.3 and not yet come back from X = 0
        std::vector<double> times{0.0}, far{0.0}, near{0.0};
        double strain = 0.0;
        for (int k = 1; k <= samples; ++k) {
          world.solver->advance(end / samples);
          times.push_back(world.solver->state().time);
          near.push_back(ring_displacement(*world.solver, 0.7 * bar.length));
          far.push_back(ring_displacement(*world.solver, 0.3 * bar.length));
          strain = std::max(strain, largest_strain(world.solver->state()));
        }
        // A symmetric pulse leaves a step behind; its middle is at half the height.
        double travel =
            time_of_level(times, far, 0.5 * far.back()) - time_of_level(times, near, 0.5 * near.back());
        return {{{"axial speed over sqrt(E/rho)", 0.4 * passage / travel}}, strain};
      }};
}

}  // namespace

std::vector<ValidationCase> motion_validation_cases() { return {dropped_beam(), wave()}; }

}  // namespace deforma
