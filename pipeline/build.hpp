#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/scene.hpp"
#include "sim/solver.hpp"

namespace deforma {

/// What became of a body of the scene.
struct BodyFacts {
  std::string name;
  std::size_t particles = 0;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t links = 0;  ///< pairs of neighbours
  double mass = 0.0;      ///< [kg]
  double volume = 0.0;    ///< [m^3]
  double spacing = 0.0;   ///< (V/N)^(1/3) [m]
};

/// A scene ready to run.
struct World {
  std::unique_ptr<Solver> solver;
  std::vector<BodyFacts> bodies;
  std::vector<std::string> warnings;  ///< what the user should know but may want
};

/// Imports, samples and links every body, places the obstacles and makes the effects that the scene calls
/// for.
/// @throws UserError with the place in the scene and what is wrong.
World build(const Scene& scene);

}  // namespace deforma
