#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pipeline/validation_case.hpp"
#include "pipeline/validation_probe.hpp"
#include "sim/modes.hpp"

namespace deforma {

namespace {

constexpr double still = 0.02;   // of the expected first bending: a lower frequency is a rigid motion's zero
constexpr double much = 0.5;     // of a mode's energy: what it is called after
constexpr double clearly = 0.9;  // of the first bending: nothing may lie lower

enum class Kind { across, twist };

/// The lowest frequency above zero of a mode of that kind. Told by its shape: where a bar's modes come in the list
/// depends on what is measured.
double first_of(Kind kind, const std::vector<Mode>& modes, const State& state, double thickness,
                double zero) {
  for (const Mode& mode : modes) {
    if (mode.frequency < zero) continue;
    SectionShares shares = section_shares(state, mode.shape, thickness);
    if ((kind == Kind::across ? shares.across : shares.twist) > much) return mode.frequency;
  }
  throw std::runtime_error(fmt::format("no {} among the lowest {} modes ({:.4g} to {:.4g} Hz)",
                                       kind == Kind::across ? "bending" : "torsion", modes.size(),
                                       modes.front().frequency, modes.back().frequency));
}

/// How many modes lie clearly below the first bending, beyond the rigid ones.
double count_below(const std::vector<Mode>& modes, double first_bending, int rigid) {
  auto count = std::count_if(modes.begin(), modes.end(),
                             [&](const Mode& mode) { return mode.frequency < clearly * first_bending; });
  return std::abs(static_cast<double>(count) - rigid);
}

ValidationCase free_bar() {
  const BarSpec bar{.clamped = false};
  return {.name = "free-bar",
          .summary = "vibrations of a free bar, L/H = 5",
          .sizes = {4, 6, 8, 10},
          .small = false,
          .weight = 30.0,
          .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
          .mesh = {},
          .measure = [bar](const Scene&, World& world, const ValidationVariant& variant) -> Measured {
            constexpr int rigid = 6;
            std::vector<Mode> modes = natural_modes(*world.solver, rigid + 4);
            const State& state = world.solver->state();
            const double zero = still * find_criterion("free-bar", "first bending").reference;
            const double thickness = bar.spacing(variant.n);
            const double bending = first_of(Kind::across, modes, state, thickness, zero);
            return {{{"first bending", bending},
                     {"first torsion", first_of(Kind::twist, modes, state, thickness, zero)},
                     {"modes below", count_below(modes, bending, rigid)}}};
          }};
}

ValidationCase clamped_bar() {
  const BarSpec bar{};
  return {.name = "clamped-bar",
          .summary = "vibrations of a clamped bar, L/H = 5",
          .sizes = {4, 6, 8, 10},
          .small = false,
          .weight = 10.0,
          .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
          .mesh = {},
          .measure = [bar](const Scene&, World& world, const ValidationVariant& variant) -> Measured {
            std::vector<Mode> modes = natural_modes(*world.solver, 3);
            const double zero = still * find_criterion("clamped-bar", "first bending").reference;
            const double bending =
                first_of(Kind::across, modes, world.solver->state(), bar.spacing(variant.n), zero);
            return {{{"first bending", bending}, {"modes below", count_below(modes, bending, 0)}}};
          }};
}

}  // namespace

std::vector<ValidationCase> mode_validation_cases() { return {free_bar(), clamped_bar()}; }

}  // namespace deforma
