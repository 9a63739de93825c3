#pragma once

#include <string>
#include <vector>

#include "pipeline/build.hpp"
#include "pipeline/scene.hpp"

// The scenes of `deforma validate`: what is validated is what a scene file runs.
namespace deforma {

/// How the particles of a validated body lie.
enum class Placement {
  lattice,
  jittered  ///< each moved at random by up to 0.2 spacings from its place on the lattice
};

std::string_view placement_name(Placement placement);

/// The placements that are validated.
std::vector<Placement> validation_placements();

/// A choice of method to validate: the lines that it adds to a scene.
struct ValidationSetting {
  std::string name;
  std::string meaning;
  bool judged;          ///< held to goals and limits; the others are shown beside
  int most_across;      ///< particles; more would take too long
  std::string solver;   ///< lines of [solver]
  std::string elastic;  ///< further keys of a body's `elastic`
  std::string body;     ///< lines of [[body]]
};

/// The default, the gradient that is not the default, and the paper's own choices, in this order.
const std::vector<ValidationSetting>& validation_settings();

/// With what a case is run.
struct ValidationVariant {
  const ValidationSetting* setting;
  Placement placement;
  int n;  ///< particles across
};

/// A square bar along x from X = 0 to `length`, centred in y and z.
struct BarSpec {
  double length = 1.0;    ///< [m]
  double width = 0.2;     ///< [m]
  double young = 1e6;     ///< [Pa]
  double poisson = 0.3;   ///< -
  double density = 1.0;   ///< [kg/m^3]
  bool clamped = true;    ///< at X = 0
  double duration = 1.0;  ///< [s]
  double fps = 25.0;
  int cells = 2;           ///< of the surface for each particle across
  std::string world = {};  ///< lines of [world]
  std::string body = {};   ///< further lines of [[body]]

  double inertia() const { return width * width * width * width / 12.0; }  ///< I [m^4]
  double spacing(int n) const { return width / n; }                        ///< [m]
};

/// A TOML region of all that lies at X = x or beyond, to rounding.
std::string region_from(double x, double length);

std::string bar_scene(const BarSpec& spec, const ValidationVariant& variant);

/// A cube of n^3 particles with its centre at `height`; `head` are lines before the body, `body` lines of it.
struct CubeSpec {
  double width = 0.6;       ///< [m]
  double height = 0.0;      ///< of its centre [m]
  double duration = 1.0;    ///< [s]
  double density = 1000.0;  ///< [kg/m^3]
  std::string solver = {};  ///< further lines of [solver]
  std::string world = {};   ///< lines of [world]
  std::string body = {};    ///< further lines of [[body]]
  std::string more = {};    ///< after the body
};

std::string cube_scene(const CubeSpec& spec, const ValidationVariant& variant);

/// Cook's membrane as a one-layer sheet in x and y whose thickness is the spacing 16/n: loads are taken per thickness.
inline constexpr std::string_view cook_mesh_name = "cook_membrane.obj";
std::string cook_scene(const ValidationVariant& variant);
std::string cook_mesh(const ValidationVariant& variant);

}  // namespace deforma
