#include <fmt/core.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <memory>

#include "pipeline/bench.hpp"
#include "sim/solver.hpp"

namespace deforma {

namespace {

constexpr Gradient fits[] = {Gradient::linear, Gradient::quadratic};

std::unique_ptr<Solver> middle_solver(Gradient gradient, int particles) {
  BenchBody body = bench_box(particles);
  body.gradient = gradient;
  if (gradient == Gradient::linear) body.links = bench_links;
  return build(bench_scene(body)).solver;
}

using Threads = tbb::global_control;

/// Seconds that every stage and effect has taken so far, by name and in running order.
std::vector<std::pair<std::string, double>> seconds_by_pass(const Solver& solver) {
  std::vector<std::pair<std::string, double>> all;
  const SolverStatistics& statistics = solver.statistics();
  for (const auto* passes : {&statistics.stages, &statistics.effects})
    for (const SolverStatistics::Pass& pass : *passes) all.emplace_back(pass.name, pass.seconds);
  return all;
}

}  // namespace

BenchTable bench_stages(const BenchSettings& settings) {
  BenchTable table = {"stages",
                      fmt::format("Where a step's time goes: {} particles, one thread, elastic + hourglass",
                                  bench_box(settings.middle).particles()),
                      {{"fit", "fit", 0},
                       {"stage", "stage", 0},
                       {"nanoseconds_per_particle", "ns per\nparticle", 1},
                       {"percent", "% of\nthe step", 1}},
                      {},
                      {}};
  Threads alone(Threads::max_allowed_parallelism, 1);
  for (Gradient gradient : fits) {
    settings.tell(fmt::format("stages: {} fit", gradient_name(gradient)));
    std::unique_ptr<Solver> solver = middle_solver(gradient, settings.middle);
    advance_steps(*solver, 3);  // measures the stable step
    // The stages of one round belong together; of each the median over the rounds.
    std::vector<std::vector<double>> taken;
    std::vector<std::string> names;
    for (int round = 0; round < settings.turns.rounds; ++round) {
      const auto before = seconds_by_pass(*solver);
      const double steps = advance_steps(*solver, settings.quick ? 3 : 10);
      const auto after = seconds_by_pass(*solver);
      taken.resize(after.size());
      names.clear();
      for (std::size_t k = 0; k < after.size(); ++k) {
        names.push_back(after[k].first);
        taken[k].push_back((after[k].second - before[k].second) / steps);
      }
    }
    double whole = 0.0;
    for (std::vector<double>& values : taken) whole += median(values);
    for (std::size_t k = 0; k < taken.size(); ++k) {
      const double seconds = median(taken[k]);
      if (seconds > 0.0)
        table.rows.push_back({std::string(gradient_name(gradient)), names[k],
                              1e9 * seconds / static_cast<double>(solver->state().size()),
                              100.0 * seconds / whole});
    }
  }
  return table;
}

BenchTable bench_threads(const BenchSettings& settings) {
  BenchTable table = {
      "threads",
      fmt::format("More threads: {} particles, elastic + hourglass", bench_box(settings.middle).particles()),
      {{"fit", "fit", 0},
       {"threads", "threads", 0},
       {"million_particle_steps_per_second", "million\nparticle-steps/s", 2},
       {"speed_up", "times\none thread", 2}},
      {},
      {}};
  std::vector<int> counts;
  for (int count = 1; count < settings.threads; count *= 2) counts.push_back(count);
  counts.push_back(settings.threads);
  for (Gradient gradient : fits) {
    settings.tell(fmt::format("threads: {} fit", gradient_name(gradient)));
    std::unique_ptr<Solver> solver = middle_solver(gradient, settings.middle);
    std::vector<std::function<double(double)>> things;
    for (int count : counts)
      things.emplace_back([&solver, count](double steps) {
        Threads some(Threads::max_allowed_parallelism, static_cast<std::size_t>(count));
        return advance_steps(*solver, steps);
      });
    Turns turns = settings.turns;
    turns.clock = Turns::Clock::wall;
    const std::vector<double> seconds = take_turns(things, turns);
    for (std::size_t k = 0; k < counts.size(); ++k)
      table.rows.push_back({std::string(gradient_name(gradient)), static_cast<double>(counts[k]),
                            1e-6 * static_cast<double>(solver->state().size()) / seconds[k],
                            seconds[0] / seconds[k]});
  }
  return table;
}

}  // namespace deforma
