#include "pipeline/validation_case.hpp"

#include <fmt/core.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "pipeline/output_folder.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/user_error.hpp"
#include "pipeline/validation_probe.hpp"
#include "sim/equilibrium.hpp"

namespace deforma {

namespace {

namespace fs = std::filesystem;

/// A folder of its own for as long as a scene is read from it.
class ScratchFolder {
 public:
  ScratchFolder() {
    static std::atomic<int> count = 0;
    path_ = fs::temp_directory_path() / fmt::format("deforma-validate-{}-{}", getpid(), count++);
    fs::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Outcome {
  std::size_t particles = 0;
  Measured measured;
  std::string trouble;
};

Outcome simulate(const ValidationCase& validated, const ValidationVariant& variant,
                 const std::vector<Override>& overrides) {
  Outcome outcome;
  try {
    Scene scene;
    World world;
    {
      ScratchFolder folder;
      scene = load_scene(write_case(validated, variant, folder.path()), overrides);
      world = build(scene);
    }
    outcome.particles = free_particles(world.solver->state());
    outcome.measured = validated.measure(scene, world, variant);
  } catch (const UserError&) {
    throw;  // an override that no scene takes
  } catch (const std::exception& error) {
    outcome.trouble = error.what();
  }
  return outcome;
}

}  // namespace

const std::vector<ValidationCase>& validation_cases() {
  static const std::vector<ValidationCase> cases = [] {
    std::vector<ValidationCase> all;
    for (auto kind : {field_validation_cases, static_validation_cases, mode_validation_cases,
                      motion_validation_cases, conservation_validation_cases})
      for (ValidationCase& one : kind()) all.push_back(std::move(one));
    return all;
  }();
  return cases;
}

void settle(Solver& solver, double tolerance) {
  Equilibrium found = find_equilibrium(solver, {.tolerance = tolerance});
  if (!found.converged)
    throw std::runtime_error(fmt::format("no equilibrium: {:.2g} of the load is left after {} iterations",
                                         found.residual, found.iterations));
}

Verdict ValidationRow::verdict() const {
  if (!judged()) return Verdict::shown;
  if (small && !(strain <= small_strain)) return Verdict::failed;
  return judge(*criterion, variant.n, value);
}

std::vector<ValidationRow> run_case(const ValidationCase& validated, const ValidationVariant& variant,
                                    const std::vector<Override>& overrides) {
  // An arena of one thread: its time is then all that the case takes.
  ThreadStopwatch watch;
  Outcome outcome;
  tbb::task_arena alone(1);
  alone.execute([&] { outcome = simulate(validated, variant, overrides); });
  const double cpu = watch.lap();

  std::vector<ValidationRow> rows;
  for (const Criterion& criterion : validation_criteria()) {
    if (criterion.case_name != validated.name) continue;
    ValidationRow row{&criterion,
                      variant,
                      outcome.particles,
                      std::numeric_limits<double>::quiet_NaN(),
                      outcome.measured.largest_strain,
                      validated.small,
                      cpu,
                      outcome.trouble};
    bool measured = false;
    for (const auto& [quantity, value] : outcome.measured.values) {
      if (quantity != criterion.quantity) continue;
      row.value = value;
      measured = true;
    }
    if (measured || !outcome.trouble.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

fs::path write_case(const ValidationCase& validated, const ValidationVariant& variant,
                    const fs::path& folder) {
  fs::path file = folder / fmt::format("{}.toml", validated.name);
  write_text(file, fmt::format("# {}: {}\n", validated.name, validated.summary) + validated.scene(variant));
  if (validated.mesh) write_text(folder / cook_mesh_name, validated.mesh(variant));
  return file;
}

}  // namespace deforma
