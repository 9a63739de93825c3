#include <fmt/core.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>

#include "pipeline/bandwidth.hpp"
#include "pipeline/bench.hpp"
#include "pipeline/commands.hpp"
#include "pipeline/output_folder.hpp"
#include "pipeline/user_error.hpp"

namespace deforma {

namespace {

using Threads = tbb::global_control;

/// One table or two that are measured together.
struct Measurement {
  std::string name;
  std::vector<BenchTable> (*measure)(const BenchSettings& settings);
};

const std::array measurements = {
    Measurement{"steps", bench_steps},
    Measurement{"stages", [](const BenchSettings& s) { return std::vector{bench_stages(s)}; }},
    Measurement{"threads", [](const BenchSettings& s) { return std::vector{bench_threads(s)}; }},
    Measurement{"effects", [](const BenchSettings& s) { return std::vector{bench_effects(s)}; }},
    Measurement{"paper", [](const BenchSettings& s) { return std::vector{bench_paper(s)}; }},
};

std::vector<const Measurement*> chosen(const BenchCommand& command) {
  std::vector<std::string> names;
  for (const Measurement& one : measurements) names.push_back(one.name);
  for (const std::string& name : command.tables)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw UserError(fmt::format("--table {}: no such table{} (allowed: {})", name,
                                  did_you_mean(name, names), fmt::join(names, ", ")));
  std::vector<const Measurement*> all;
  for (const Measurement& one : measurements)
    if (command.tables.empty() ||
        std::find(command.tables.begin(), command.tables.end(), one.name) != command.tables.end())
      all.push_back(&one);
  return all;
}

std::string processor_name() {
  std::ifstream facts("/proc/cpuinfo");
  for (std::string line; std::getline(facts, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "an unknown processor";
}

BenchMachine measure_machine() {
  BenchMachine machine;
  machine.processor = processor_name();
  machine.processors = static_cast<int>(tbb::info::default_concurrency());
  machine.threads = static_cast<int>(Threads::active_value(Threads::max_allowed_parallelism));
  machine.bandwidth_all = measure_bandwidth(Turns::Clock::wall);
  Threads alone(Threads::max_allowed_parallelism, 1);
  machine.bandwidth = measure_bandwidth(Turns::Clock::thread);
  return machine;
}

BenchSettings settings_for(const BenchCommand& command, const BenchMachine& machine) {
  BenchSettings settings;
  settings.sizes = command.sizes;
  settings.quick = command.quick;
  settings.threads = machine.threads;
  settings.bandwidth = machine.bandwidth;
  if (command.sizes.empty())
    settings.sizes =
        command.quick ? std::vector{300, 1000, 8000} : std::vector{300, 1000, 8000, 64000, 100000, 1000000};
  if (command.quick) {
    settings.middle = 8000;
    settings.turns.rounds = 3;
    settings.turns.seconds = 0.02;
  }
  if (!command.quiet)
    settings.tell = [](const std::string& what) { fmt::print(stderr, "measuring {}\n", what); };
  return settings;
}

}  // namespace

int bench(const BenchCommand& command) {
  const std::vector<const Measurement*> all = chosen(command);
  std::optional<Threads> threads;
  if (command.threads > 0)
    threads.emplace(Threads::max_allowed_parallelism, static_cast<std::size_t>(command.threads));
  const BenchMachine machine = measure_machine();
  fmt::print("{}", bench_text(machine));
  const BenchSettings settings = settings_for(command, machine);
  std::vector<BenchTable> tables;
  for (const Measurement* one : all) {
    for (BenchTable& table : one->measure(settings)) {
      fmt::print("\n{}", bench_text(table));
      std::fflush(stdout);
      tables.push_back(std::move(table));
    }
  }
  if (!command.json.empty()) write_text(command.json, bench_json(machine, tables));
  return exit_ok;
}

}  // namespace deforma
