#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Contact of the visible surface with obstacles, with other bodies that have this table, and with itself:
/// penalty springs at the surface vertices, restitution and Coulomb friction (sim/contact_law.hpp,
/// sim/contact_body.hpp). The normal force of closing surfaces is the exact gradient of its energy; between
/// bodies it acts on the vertex and on the three corners of the triangle it has passed, so that momentum is
/// kept pair by pair.
///
/// Only vertices feel. An obstacle's edge, or another body's, can enter a triangle between its corners:
/// surfaces should be about as fine as their particles.
const EffectInfo& contact_effect();

}  // namespace deforma
