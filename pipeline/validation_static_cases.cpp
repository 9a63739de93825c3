#include <fmt/core.h>

#include "pipeline/validation_case.hpp"
#include "pipeline/validation_probe.hpp"
#include "pipeline/validation_reference.hpp"

namespace deforma {

namespace {

std::string end_load(const Vec3& force, double length) {
  return fmt::format("load = {{ force = [{}, {}, {}], region = {} }}\n", force.x(), force.y(), force.z(),
                     region_from(length, length));
}

ValidationCase cantilever(std::string_view name, std::string_view summary, double poisson) {
  BarSpec bar{.poisson = poisson};
  const double tip = 1e-3 * bar.length;  // of a Timoshenko beam: strains stay below 1e-3
  const double force = tip / reference::end_loaded_tip(1.0, bar.length, bar.width, bar.young, poisson);
  bar.body = end_load(Vec3(0, 0, -force), bar.length);
  return {.name = name,
          .summary = summary,
          .sizes = {4, 6, 8, 10},
          .small = true,
          .weight = 5.0,
          .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
          .mesh = {},
          .measure = [bar, tip](const Scene&, World& world, const ValidationVariant&) -> Measured {
            settle(*world.solver);
            return {{{"tip over Timoshenko's", -face_displacement(*world.solver, bar.length).z() / tip}},
                    largest_strain(world.solver->state())};
          }};
}

ValidationCase hanging_bar() {
  constexpr double elongation = 1.5e-4;  // rho g L^2 / 2E [m], of 1 m
  BarSpec bar{.poisson = 0.0};
  bar.world = fmt::format("gravity = [{}, 0, 0]\n",
                          2.0 * bar.young * elongation / (bar.density * bar.length * bar.length));
  return {.name = "hanging-bar",
          .summary = "a bar under its own weight, which acts along it",
          .sizes = {4, 6, 8, 10},
          .small = true,
          .weight = 5.0,
          .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
          .mesh = {},
          .measure = [bar](const Scene&, World& world, const ValidationVariant&) -> Measured {
            settle(*world.solver);
            return {{{"elongation over rho g L2/2E",
                      face_displacement(*world.solver, bar.length).x() / elongation}},
                    largest_strain(world.solver->state())};
          }};
}

ValidationCase elastica(std::string_view name, std::string_view quantity, double load) {
  BarSpec bar{.width = 0.05, .poisson = 0.0, .cells = 1};
  bar.body = end_load(Vec3(0, 0, -load * bar.young * bar.inertia() / (bar.length * bar.length)), bar.length);
  return {.name = name,
          .summary = "a bar with L/H = 20 under a dead load at its end that bends it far",
          .sizes = {4, 6, 8, 10},
          .small = false,
          .weight = 100.0,
          .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
          .mesh = {},
          .measure = [bar, quantity](const Scene&, World& world, const ValidationVariant&) -> Measured {
            settle(*world.solver);
            return {{{quantity, -face_displacement(*world.solver, bar.length).z() / bar.length}},
                    largest_strain(world.solver->state())};
          }};
}

/// A strip along one edge of the end face, and the unit force on it.
struct Strip {
  Region region;
  Vec3 direction;
};

/// Four strips, a quarter of the width each, pushed round the axis.
std::array<Strip, 4> torsion_strips(const BarSpec& bar) {
  const double inf = std::numeric_limits<double>::infinity();
  const double x = bar.length * (1.0 - 1e-6), side = 0.25 * bar.width * (1.0 - 1e-6);
  return {{{{.min = Vec3(x, side, -inf)}, Vec3(0, 0, 1)},
           {{.min = Vec3(x, -inf, -inf), .max = Vec3(inf, -side, inf)}, Vec3(0, 0, -1)},
           {{.min = Vec3(x, -inf, side)}, Vec3(0, -1, 0)},
           {{.min = Vec3(x, -inf, -inf), .max = Vec3(inf, inf, -side)}, Vec3(0, 1, 0)}}};
}

/// The torque of the strips about the bar's axis [N m]: each force acts where its strip's area lies.
double torque(const BarSpec& bar, const Surface& surface, double force) {
  double sum = 0.0;
  for (const Strip& strip : torsion_strips(bar)) {
    double area = 0.0;
    Vec3 moment = Vec3::Zero();
    for (std::size_t s = 0; s < surface.size(); ++s) {
      if (!strip.region.contains(surface.rest[s])) continue;
      area += surface.area[s];
      moment += surface.area[s] * surface.rest[s];
    }
    sum += force * (moment / area).cross(strip.direction).x();
  }
  return sum;
}

std::string triple(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

ValidationCase torsion() {
  BarSpec bar{.length = 1.2};
  constexpr double force = 0.4;  // N on each strip: shear strains of a few 1e-4
  bar.body = "load = [\n";
  for (const Strip& strip : torsion_strips(bar))
    bar.body +=
        fmt::format("  {{ force = {}, region = {{ min = {}, max = {} }} }},\n",
                    triple(force * strip.direction), triple(strip.region.min), triple(strip.region.max));
  bar.body += "]\n";
  return {
      .name = "torsion",
      .summary =
          "a square bar with L/H = 6 twisted at its end; the twist of its middle, one width from both ends",
      .sizes = {4, 6, 8, 10},
      .small = true,
      .weight = 6.0,
      .scene = [bar](const ValidationVariant& variant) { return bar_scene(bar, variant); },
      .mesh = {},
      .measure = [bar](const Scene&, World& world, const ValidationVariant&) -> Measured {
        const double shear_modulus = 0.5 * bar.young / (1.0 + bar.poisson);
        const double constant = 0.1406 * 12.0 * bar.inertia();  // J = 0.1406 a^4
        const double expected =
            torque(bar, world.solver->state().surface, force) / (shear_modulus * constant);
        settle(*world.solver);
        return {
            {{"twist over TL/GJ", twist_rate(*world.solver, bar.width, bar.length - bar.width) / expected}},
            largest_strain(world.solver->state())};
      }};
}

}  // namespace

std::vector<ValidationCase> static_validation_cases() {
  return {
      cantilever("cantilever", "a clamped bar, L/H = 5, nu = 0.3, with a small load at its end", 0.3),
      cantilever("cantilever-nu45", "a clamped bar, L/H = 5, nu = 0.45, with a small load at its end", 0.45),
      hanging_bar(),
      elastica("elastica-1", "v/L at PL2/EI = 1", 1.0),
      elastica("elastica-2", "v/L at PL2/EI = 2", 2.0),
      elastica("elastica-5", "v/L at PL2/EI = 5", 5.0),
      elastica("elastica-10", "v/L at PL2/EI = 10", 10.0),
      torsion()};
}

}  // namespace deforma
