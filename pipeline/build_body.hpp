#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "assets/mesh.hpp"
#include "pipeline/scene.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Scenes turn in degrees.
inline constexpr double radians_per_degree = std::numbers::pi / 180.0;

/// The surface of a body where the scene puts it [m], as fine as the scene asks, outside out.
/// @throws UserError with the place in the scene, when the mesh cannot be read or the shape not be made.
Mesh make_body_mesh(const SceneBody& body, std::vector<std::string>& warnings);

/// Fills the mesh with particles and appends body, particles and surface to the state.
/// @param bytes_per_particle what the simulation will take for each, to refuse more than the memory holds
/// @throws UserError with the place in the scene, when the mesh cannot be sampled.
void append_body(State& state, const SceneBody& body, const Mesh& mesh, double bytes_per_particle,
                 std::vector<std::string>& warnings);

}  // namespace deforma
