#include <fmt/core.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <iterator>
#include <mutex>

#include "pipeline/commands.hpp"
#include "pipeline/output_folder.hpp"
#include "pipeline/thread_count.hpp"
#include "pipeline/user_error.hpp"
#include "pipeline/validation_table.hpp"

namespace deforma {

namespace {

namespace fs = std::filesystem;

/// One case with one setting, placement and number of particles.
struct Job {
  const ValidationCase* validated;
  ValidationVariant variant;

  double work() const {
    const double n = variant.n;
    return validated->weight * n * n * n * n;
  }
};

/// The cases that a name means: the one of that name, or all that begin with it and a hyphen.
std::vector<const ValidationCase*> cases_named(const std::string& name) {
  std::vector<const ValidationCase*> family;
  std::vector<std::string> names;
  for (const ValidationCase& one : validation_cases()) {
    if (one.name == name) return {&one};
    if (one.name.starts_with(name + "-")) family.push_back(&one);
    names.emplace_back(one.name);
  }
  if (family.empty())
    throw UserError(fmt::format("--case {}: no such case{} (allowed: {})", name, did_you_mean(name, names),
                                fmt::join(names, ", ")));
  return family;
}

std::vector<const ValidationCase*> chosen_cases(const ValidateCommand& command) {
  std::vector<const ValidationCase*> chosen;
  auto add = [&](const ValidationCase* one) {
    if (std::find(chosen.begin(), chosen.end(), one) == chosen.end()) chosen.push_back(one);
  };
  for (const std::string& name : command.cases)
    for (const ValidationCase* one : cases_named(name)) add(one);
  if (command.cases.empty())
    for (const ValidationCase& one : validation_cases()) add(&one);
  return chosen;
}

std::vector<const ValidationSetting*> chosen_settings(const ValidateCommand& command) {
  std::vector<const ValidationSetting*> chosen;
  std::vector<std::string> names = {"all"};
  for (const ValidationSetting& setting : validation_settings()) names.push_back(setting.name);
  for (const std::string& name : command.settings)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw UserError(fmt::format("--settings {}: no such setting{} (allowed: {})", name,
                                  did_you_mean(name, names), fmt::join(names, ", ")));
  auto asked = [&](const std::string& name) {
    return std::find(command.settings.begin(), command.settings.end(), name) != command.settings.end();
  };
  for (const ValidationSetting& setting : validation_settings())
    if (asked("all") || asked(setting.name) ||
        (command.settings.empty() && (setting.judged || !command.quick)))
      chosen.push_back(&setting);
  return chosen;
}

/// Particles across: those asked for, or the case's own; a case of one size has no other.
std::vector<int> chosen_sizes(const ValidateCommand& command, const ValidationCase& validated) {
  std::vector<int> sizes;
  const bool any = validated.sizes.size() > 1 && !command.sizes.empty();
  for (int n : any ? command.sizes : validated.sizes) {
    const bool asked = any || command.sizes.empty() ||
                       std::find(command.sizes.begin(), command.sizes.end(), n) != command.sizes.end();
    const bool twice = std::find(sizes.begin(), sizes.end(), n) != sizes.end();
    if (asked && !twice && !(command.quick && n > 6)) sizes.push_back(n);
  }
  return sizes;
}

std::vector<Job> chosen_jobs(const ValidateCommand& command) {
  std::vector<Job> jobs;
  for (const ValidationCase* validated : chosen_cases(command))
    for (const ValidationSetting* setting : chosen_settings(command))
      for (Placement placement : validation_placements())
        for (int n : chosen_sizes(command, *validated))
          if (n <= setting->most_across) jobs.push_back({validated, {setting, placement, n}});
  return jobs;
}

/// Says on standard error which runs are done: on a terminal in one line, else a line each.
class JobProgress {
 public:
  JobProgress(std::size_t total, bool quiet)
      : total_(total), quiet_(quiet), terminal_(isatty(STDERR_FILENO)) {}

  void done(const Job& job, double cpu) {
    std::lock_guard lock(mutex_);
    ++done_;
    if (quiet_) return;
    fmt::print(stderr, "{}[{}/{}] {}, {}, {}, n = {}: {:.1f} s{}", terminal_ ? "\r\x1b[K" : "", done_, total_,
               job.validated->name, placement_name(job.variant.placement), job.variant.setting->name,
               job.variant.n, cpu, terminal_ && done_ < total_ ? "" : "\n");
    std::fflush(stderr);
  }

 private:
  std::mutex mutex_;
  std::size_t done_ = 0, total_;
  bool quiet_, terminal_;
};

/// Runs independent cases side by side, each on a thread of its own, the longest first.
std::vector<ValidationRow> run_jobs(std::vector<Job> jobs, const std::vector<Override>& overrides,
                                    bool quiet) {
  std::stable_sort(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) { return a.work() > b.work(); });
  std::vector<std::vector<ValidationRow>> results(jobs.size());
  JobProgress progress(jobs.size(), quiet);
  std::atomic<std::size_t> next = 0;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, jobs.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& block) {
        for (std::size_t k = block.begin(); k != block.end(); ++k) {
          std::size_t j = next++;  // in this order, whatever part of the range a thread has taken
          results[j] = run_case(*jobs[j].validated, jobs[j].variant, overrides);
          progress.done(jobs[j], results[j].empty() ? 0.0 : results[j].front().cpu);
        }
      },
      tbb::simple_partitioner());
  std::vector<ValidationRow> rows;
  for (auto& result : results) std::move(result.begin(), result.end(), std::back_inserter(rows));
  sort_rows(rows);
  return rows;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw UserError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

int list_cases() {
  for (const ValidationCase& one : validation_cases())
    fmt::print("{:<18} n = {:<14} {}\n", one.name, fmt::to_string(fmt::join(one.sizes, ", ")), one.summary);
  return exit_ok;
}

int write_scenes(const ValidateCommand& command) {
  make_folder(command.scenes);
  constexpr int n = 6;
  const ValidationSetting& setting = *chosen_settings(command).front();
  for (const ValidationCase* validated : chosen_cases(command))
    fmt::print("{}\n", write_case(*validated, {&setting, Placement::lattice, n}, command.scenes).string());
  return exit_ok;
}

}  // namespace

int validate(const ValidateCommand& command) {
  if (command.list) return list_cases();
  if (!command.scenes.empty()) return write_scenes(command);
  std::vector<Job> jobs = chosen_jobs(command);
  if (jobs.empty())
    throw UserError("nothing to validate: no chosen case has as many particles across as chosen");
  if (!command.folder.empty()) make_folder(command.folder);
  std::vector<Override> overrides;
  for (const std::string& set : command.sets) overrides.push_back(parse_override(set));
  std::vector<ValidationRow> rows =
      on_threads(command.threads, [&] { return run_jobs(std::move(jobs), overrides, command.quiet); });
  fmt::print("{}", validation_text(rows));
  if (!command.folder.empty()) {
    write_text(fs::path(command.folder) / "validation.md", validation_markdown(rows));
    write_text(fs::path(command.folder) / "validation.csv", validation_csv(rows));
  }
  return all_limits_kept(rows) ? exit_ok : exit_failure;
}

}  // namespace deforma
