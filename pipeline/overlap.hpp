#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/mesh.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Looks for bodies that begin inside one another or inside something solid. Contact eases a shallow overlap out; a
/// deep one it would throw out at any speed.
/// @param meshes of the bodies, where they begin
/// @param touching file, line and key of each body that has contact; empty for one without
/// @param warnings shallow overlaps, and all of bodies without contact
/// @throws UserError for a body with contact that begins deep inside something it touches.
void check_overlaps(const State& state, std::span<const Mesh> meshes, std::span<const std::string> touching,
                    std::vector<std::string>& warnings);

}  // namespace deforma
