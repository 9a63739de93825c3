#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/mesh.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Tells of bodies that begin inside one another or inside something solid: contact would throw them out.
/// @param meshes of the bodies, where they begin
void warn_of_overlaps(const State& state, std::span<const Mesh> meshes, std::vector<std::string>& warnings);

}  // namespace deforma
