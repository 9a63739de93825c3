#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "assets/import.hpp"
#include "assets/mesh.hpp"
#include "pipeline/commands.hpp"
#include "pipeline/files.hpp"
#include "pipeline/output_folder.hpp"
#include "pipeline/user_error.hpp"
#include "sim/types.hpp"

namespace deforma {

namespace {

namespace fs = std::filesystem;

/// Three digits are enough to start from.
double rounded(double value) {
  if (value == 0.0) return 0.0;
  double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  return std::round(value / unit) * unit;
}

std::string number(double value) { return fmt::format("{:.6g}", rounded(value)); }

/// The lengths that a starter scene is fitted to.
struct Fit {
  std::string source;      ///< the line that says which mesh
  double rotation = 20.0;  ///< about x [degrees]
  double height = 0.8;     ///< of the body [m]
  double size = 0.8;       ///< its longest side [m]
  Vec3 position = {0, 0,
                   0.9};  ///< of the mesh's origin, so that it begins half its height above the ground [m]
};

Fit fit_to_mesh(const NewCommand& options) {
  fs::path scene_here = "scene.toml";
  fs::path file = find_mesh(options.mesh, scene_here);
  if (file.empty()) throw UserError("--from: " + missing_mesh_message(options.mesh, scene_here));
  Mesh mesh;
  try {
    mesh = import_mesh(file).mesh;
  } catch (const std::runtime_error& error) {
    throw UserError(fmt::format("--from: {}", error.what()));
  }
  MeshFacts facts = inspect(mesh);
  Vec3 extent = facts.max - facts.min;
  Fit fit;
  fit.rotation = 0.0;
  fit.height = std::max(extent.z(), 1e-3 * extent.maxCoeff());
  fit.size = extent.maxCoeff();
  Vec3 middle = 0.5 * (facts.min + facts.max);
  fit.position = {-middle.x(), -middle.y(), 0.5 * fit.height - facts.min.z()};
  std::string name = file.string();
  if (is_installed_mesh(file))
    name = file.filename().string();
  else if (!options.file.empty())
    name = fs::proximate(file, fs::absolute(options.file).parent_path()).generic_string();
  fit.source = fmt::format("mesh = \"{}\"  # relative to this file", name);
  return fit;
}

std::string starter_scene(const Fit& fit) {
  constexpr double gravity = 9.81, density = 1000.0;
  // Soft enough that it bends visibly under its own fall, stiff enough to stand: a few percent under its
  // weight.
  double young = rounded(40.0 * density * gravity * fit.height);
  double fall = std::sqrt(2.0 * 0.5 * fit.height / gravity);
  double duration = std::clamp(std::ceil(10.0 * 8.0 * fall) / 10.0, 0.5, 20.0);
  return fmt::format(R"(# A scene for deforma: try it with `deforma check FILE`, then `deforma run FILE`.
# All quantities are in SI units; `deforma effects` lists every effect with its settings.
duration = {duration}  # s
fps = 25

[output]
size = [1280, 720]  # pixels
view = "surface"    # or "particles", "both"

[world]
gravity = [0, 0, -9.81]  # m/s2; for every body

[[body]]
{source}
position = [{x}, {y}, {z}]  # where the mesh's own origin goes, m
rotation = [{rotation}, 0, 0]  # axis times angle, degrees: 90 stands a model up whose up is y
particles = 1500
density = 1000  # kg/m3
elastic = {{ young = {young}, poisson = 0.3 }}  # Pa, -
contact = true  # with obstacles, the ground and other bodies
damping = 0.5  # 1/s
look = {{ color = "#cc5533" }}

[ground]
height = {ground}  # m
friction = 0.5

# [[obstacle]]  # a glass box open at its upper end
# shape = {{ type = "box", size = [{box}, {box}, {box}], inside = true, open = true }}
# position = [0, 0, {half_box}]
)",
                     fmt::arg("duration", duration), fmt::arg("source", fit.source),
                     fmt::arg("x", number(fit.position.x())), fmt::arg("y", number(fit.position.y())),
                     fmt::arg("z", number(fit.position.z() + 0.2 * fit.size)),
                     fmt::arg("rotation", fit.rotation), fmt::arg("young", young), fmt::arg("ground", 0),
                     fmt::arg("box", number(2.0 * fit.size)), fmt::arg("half_box", number(fit.size)));
}

}  // namespace

int write_new_scene(const NewCommand& options) {
  Fit fit;
  fit.source = "shape = { type = \"cylinder\", radius = 0.3, height = 0.8 }  # or mesh = \"file.obj\"";
  if (!options.mesh.empty()) fit = fit_to_mesh(options);
  std::string scene = starter_scene(fit);
  if (options.file.empty()) {
    fmt::print("{}", scene);
    return exit_ok;
  }
  std::error_code ignored;
  if (fs::exists(options.file, ignored))
    throw UserError(fmt::format("{}: exists; give another file with -o", options.file));
  try {
    write_text(options.file, scene);
  } catch (const std::runtime_error& error) {
    throw UserError(error.what());
  }
  return exit_ok;
}

}  // namespace deforma
