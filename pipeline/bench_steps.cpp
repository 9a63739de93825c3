#include <fmt/core.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "pipeline/bench.hpp"
#include "pipeline/reference_loop.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/user_error.hpp"
#include "sim/memory.hpp"

namespace deforma {

namespace {

/// Bodies up to this size are measured without hourglass control, too.
constexpr int most_for_elastic_alone = 64000;

double mean_links(const State& state) {
  return static_cast<double>(state.links.links.size()) / static_cast<double>(state.size());
}

std::string kind_of(const BenchBody& body) {
  return fmt::format("{}, elastic{}", gradient_name(body.gradient), body.hourglass ? " + hourglass" : "");
}

/// A body, built, beside the loop that it is compared with.
struct Contestants {
  BenchBody body;
  double build_seconds;
  std::unique_ptr<Solver> solver;
  std::unique_ptr<ReferenceLoop> reference;
  double dt;

  explicit Contestants(const BenchBody& measured) : body(measured) {
    const Scene scene = bench_scene(body);
    Stopwatch watch;
    solver = build(scene).solver;
    build_seconds = watch.lap();
    reference = std::make_unique<ReferenceLoop>(
        solver->state(),
        ReferenceMaterial{bench_young, bench_poisson, body.hourglass ? body.usual_hourglass() : 0.0});
    dt = solver->stable_step();
  }
};

/// What the tables have measured so far.
struct Tables {
  BenchTable steps, building;
  struct Point {
    double particles, seconds;
  };
  std::vector<Point> growth[2];  // by fit, of steps with hourglass control
};

void measure(const std::vector<std::unique_ptr<Contestants>>& all, const BenchSettings& settings,
             Tables& tables) {
  constexpr std::size_t each = 3;  // the program and both codes of the reference
  std::vector<std::function<double(double)>> things;
  for (const auto& one : all) {
    things.emplace_back([&one](double steps) { return advance_steps(*one->solver, steps); });
    for (auto code : {ReferenceLoop::Code::best, ReferenceLoop::Code::eigen})
      things.emplace_back([&one, code](double steps) {
        one->reference->advance(static_cast<int>(steps), one->dt, code);
        return steps;
      });
  }
  std::vector<double> seconds;
  {
    tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    seconds = take_turns(things, settings.turns);
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    const BenchBody& body = all[k]->body;
    const double ours = seconds[each * k], arrays = seconds[each * k + 1], eigen = seconds[each * k + 2];
    const double particles = body.particles();
    const double links = mean_links(all[k]->solver->state());
    const auto bytes = static_cast<double>(bytes_per_step(*all[k]->solver));
    tables.steps.rows.push_back({kind_of(body), particles, links, 1e6 * ours, 1e-6 * particles / ours,
                                 1e-6 * links * particles / ours, bytes / particles,
                                 100.0 * bytes / ours / settings.bandwidth, 1e-6 * particles / arrays,
                                 arrays / ours, 1e-6 * particles / eigen, eigen / ours});
    if (!body.hourglass) continue;
    tables.growth[body.gradient == Gradient::quadratic].push_back({particles, ours});
    const double build = all[k]->build_seconds;
    tables.building.rows.push_back({std::string(gradient_name(body.gradient)), particles, links, build,
                                    1e6 * build / particles,
                                    static_cast<double>(all[k]->solver->statistics().bytes()) / particles});
  }
}

void measure_size(int size, Gradient gradient, const BenchSettings& settings, Tables& tables) {
  BenchBody body = bench_box(size);
  body.gradient = gradient;
  if (gradient == Gradient::linear) body.links = bench_links;
  settings.tell(fmt::format("steps: {} particles, {} fit", body.particles(), gradient_name(gradient)));
  std::vector<std::unique_ptr<Contestants>> all;
  try {
    if (gradient == Gradient::linear && size <= most_for_elastic_alone) {
      body.hourglass = false;
      all.push_back(std::make_unique<Contestants>(body));
      body.hourglass = true;
    }
    all.push_back(std::make_unique<Contestants>(body));
  } catch (const UserError& error) {  // more than the memory holds
    tables.steps.notes.push_back(error.what());
    return;
  }
  measure(all, settings, tables);
}

/// How much longer a step takes with ten times the particles, from about 1e4 of them on.
void note_growth(Gradient gradient, const std::vector<Tables::Point>& points, BenchTable& table) {
  constexpr double least = 8000.0;
  std::vector<Tables::Point> large;
  for (const Tables::Point& point : points)
    if (point.particles >= least) large.push_back(point);
  if (large.size() < 2) return;
  const auto& a = large.front();
  const auto& b = large.back();
  const double factor = std::pow(b.seconds / a.seconds, 1.0 / std::log10(b.particles / a.particles));
  table.notes.push_back(
      fmt::format("From {} to {} particles the {} fit's time per step grows {:.1f} times per decade.",
                  a.particles, b.particles, gradient_name(gradient), factor));
}

}  // namespace

double advance_steps(Solver& solver, double steps) {
  const auto before = solver.statistics().substeps;
  // A little less than so many steps are long: the solver makes whole ones of it.
  solver.advance((steps - 0.02) * solver.stable_step());
  return static_cast<double>(solver.statistics().substeps - before);
}

std::size_t bytes_per_step(const Solver& solver) {
  const State& state = solver.state();
  constexpr std::size_t number = sizeof(double), vector = sizeof(Vec3), matrix = sizeof(Mat3);
  const std::size_t gathers = state.fit.quadratic() ? 3 : 2;
  const std::size_t carried = 2 * matrix + 2 * vector;  // stress and force, written and read
  const std::size_t motion =
      2 * vector + 2 * (2 * vector + number);  // a drift of u, two kicks of v with the mass
  const std::size_t before = matrix;           // F of the last step, for the step control
  // Links, what the fit knows of them, and F written, once; the links again for each further gather, with u and X.
  return strain_bytes(state) + (gathers - 1) * bytes_of(state.links.links) +
         state.size() * (gathers * 2 * vector + carried + motion + before);
}

std::vector<BenchTable> bench_steps(const BenchSettings& settings) {
  Tables tables;
  tables.steps = {
      "steps",
      "Whole steps on one thread, in million particle-steps/s; beside them the same physics by a plain "
      "loop over arrays, and by one written with Eigen",
      {{"kind", "", 0},
       {"particles", "particles", 0},
       {"links_per_particle", "links\neach", 1},
       {"step_microseconds", "us\nper step", 1},
       {"million_particle_steps_per_second", "million\nper s", 2},
       {"million_links_per_second", "million\nlinks/s", 0},
       {"bytes_per_particle_step", "bytes\neach", 0},
       {"bandwidth_percent", "% of\nbandwidth", 0},
       {"plain_loop_million_particle_steps_per_second", "plain\nloop", 2},
       {"times_plain_loop", "times\nthat", 2},
       {"eigen_loop_million_particle_steps_per_second", "Eigen\nloop", 2},
       {"times_eigen_loop", "times\nthat", 2}},
      {},
      {}};
  tables.building = {"building",
                     fmt::format("Building, from a mesh and a number of particles, on {} thread{}",
                                 settings.threads, settings.threads == 1 ? "" : "s"),
                     {{"fit", "fit", 0},
                      {"particles", "particles", 0},
                      {"links_per_particle", "links\neach", 1},
                      {"seconds", "seconds", 2},
                      {"microseconds_per_particle", "us per\nparticle", 1},
                      {"bytes_per_particle", "bytes per\nparticle", 0}},
                     {},
                     {}};
  for (Gradient gradient : {Gradient::linear, Gradient::quadratic})
    for (int size : settings.sizes) measure_size(size, gradient, settings, tables);
  for (Gradient gradient : {Gradient::linear, Gradient::quadratic})
    note_growth(gradient, tables.growth[gradient == Gradient::quadratic], tables.steps);
  return {std::move(tables.steps), std::move(tables.building)};
}

}  // namespace deforma
