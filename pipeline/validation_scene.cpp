#include "pipeline/validation_scene.hpp"

#include <fmt/core.h>

#include <cmath>

#include "sim/moving_least_squares.hpp"

namespace deforma {

namespace {

/// The line that moves the particles from their lattice.
std::string arrangement(Placement placement) {
  return placement == Placement::jittered ? "jitter = 0.2  # spacings\n" : "";
}

/// Clamps a body's face at X = 0: the pin holds that part of the surface, where it stands.
std::string clamp(double spacing) {
  return fmt::format("pin = {{ region = {{ max = [{}, inf, inf] }} }}\n", 1e-6 * spacing);
}

/// Name, duration and [solver], [world]: what comes before the body.
std::string head(double duration, double fps, const std::string& solver, const std::string& world) {
  return fmt::format("duration = {}\nfps = {}\n[output]\nvideo = \"none\"\n[solver]\n{}[world]\n{}", duration,
                     fps, solver, world);
}

std::string elastic(double young, double poisson, const ValidationSetting& setting) {
  return fmt::format("elastic = {{ young = {}, poisson = {}{} }}\n{}", young, poisson, setting.elastic,
                     setting.body);
}

ValidationSetting other_gradient() {
  bool quadratic = SolverSpec().gradient == gradient_name(Gradient::quadratic);
  std::string name(gradient_name(quadratic ? Gradient::linear : Gradient::quadratic));
  return {name,
          fmt::format("the {} fit of the gradient, all else as it comes with it", name),
          false,
          20,
          fmt::format("gradient = \"{}\"\n", name),
          "",
          ""};
}

}  // namespace

std::string_view placement_name(Placement placement) {
  return placement == Placement::lattice ? "lattice" : "jittered";
}

std::vector<Placement> validation_placements() { return {Placement::lattice, Placement::jittered}; }

const std::vector<ValidationSetting>& validation_settings() {
  static const std::vector<ValidationSetting> settings = {
      {"default",
       fmt::format("what a scene gets that asks for nothing (gradient = \"{}\")", SolverSpec().gradient),
       true, 20, "", "", ""},
      other_gradient(),
      {"paper",
       "the paper's: linear fit, poly6 kernel with h = 3 mean distances of the nearest 10, "
       "St.Venant-Kirchhoff, its masses (eq 10), no hourglass control",
       false, 6, "gradient = \"linear\"\nkernel = \"poly6\"\nneighbors = 10\nsupport = 3\n",
       ", material = \"st_venant_kirchhoff\"", "hourglass = false\nmass_rule = \"paper\"\n"}};
  return settings;
}

std::string region_from(double x, double length) {
  return fmt::format("{{ min = [{}, -inf, -inf] }}", x - 1e-6 * length);
}

std::string bar_scene(const BarSpec& spec, const ValidationVariant& variant) {
  double spacing = spec.spacing(variant.n);
  return head(spec.duration, spec.fps, variant.setting->solver, spec.world) +
         fmt::format(
             "[[body]]\nname = \"bar\"\n"
             "shape = {{ type = \"box\", size = [{0}, {1}, {1}], resolution = {2} }}\n"
             "position = [{3}, 0, 0]\nspacing = {4}\ndensity = {5}\n",
             spec.length, spec.width, std::lround(spec.cells * spec.length / spacing), 0.5 * spec.length,
             spacing, spec.density) +
         arrangement(variant.placement) + elastic(spec.young, spec.poisson, *variant.setting) +
         (spec.clamped ? clamp(spacing) : "") + spec.body;
}

std::string cube_scene(const CubeSpec& spec, const ValidationVariant& variant) {
  return head(spec.duration, 25.0, variant.setting->solver + spec.solver, spec.world) +
         fmt::format(
             "[[body]]\nname = \"cube\"\n"
             "shape = {{ type = \"box\", size = [{0}, {0}, {0}], resolution = {1} }}\n"
             "position = [0, 0, {2}]\nspacing = {3}\ndensity = {4}\n",
             spec.width, variant.n, spec.height, spec.width / variant.n, spec.density) +
         arrangement(variant.placement) + elastic(1e6, 0.3, *variant.setting) + spec.body + spec.more;
}

namespace {

constexpr double cook_width = 48.0, cook_root = 44.0, cook_edge = 16.0;

}  // namespace

std::string cook_scene(const ValidationVariant& variant) {
  double spacing = cook_edge / variant.n;
  return head(1.0, 25.0, variant.setting->solver, "") +
         fmt::format("[[body]]\nname = \"membrane\"\nmesh = \"{}\"\nspacing = {}\n", cook_mesh_name,
                     spacing) +
         arrangement(variant.placement) + elastic(1.0, 1.0 / 3.0, *variant.setting) + clamp(spacing) +
         fmt::format("load = {{ force = [0, {}, 0], region = {} }}\n", 1e-4 * spacing,
                     region_from(cook_width, cook_width));
}

std::string cook_mesh(const ValidationVariant& variant) {
  const double spacing = cook_edge / variant.n;
  const int cells = 2 * variant.n;  // an even number: a vertex lies at the middle of the loaded edge
  auto point = [&](int i, int j, int side) {
    double x = cook_width * i / cells;
    double low = cook_root / cook_width * x;
    double high = cook_root + cook_edge / cook_width * x;
    return fmt::format("v {} {} {}\n", x, low + (high - low) * j / cells, (side - 0.5) * spacing);
  };
  std::string text;
  for (int side : {0, 1})
    for (int i = 0; i <= cells; ++i)
      for (int j = 0; j <= cells; ++j) text += point(i, j, side);
  auto index = [&](int i, int j, int side) { return 1 + ((side * (cells + 1)) + i) * (cells + 1) + j; };
  auto quad = [&](int a, int b, int c, int d) {
    text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", a, b, c, d);
  };
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      quad(index(i, j, 1), index(i + 1, j, 1), index(i + 1, j + 1, 1), index(i, j + 1, 1));
      quad(index(i, j, 0), index(i, j + 1, 0), index(i + 1, j + 1, 0), index(i + 1, j, 0));
    }
    quad(index(i, 0, 0), index(i + 1, 0, 0), index(i + 1, 0, 1), index(i, 0, 1));
    quad(index(i + 1, cells, 0), index(i, cells, 0), index(i, cells, 1), index(i + 1, cells, 1));
    quad(index(0, i + 1, 0), index(0, i, 0), index(0, i, 1), index(0, i + 1, 1));
    quad(index(cells, i, 0), index(cells, i + 1, 0), index(cells, i + 1, 1), index(cells, i, 1));
  }
  return text;
}

}  // namespace deforma
