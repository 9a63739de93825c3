#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Contact of the visible surface with obstacles, with other bodies that have this table, and with itself: penalty
/// springs at the surface vertices, restitution and Coulomb friction (sim/contact_law.hpp, sim/contact_body.hpp).
/// The normal force of closing surfaces is the exact gradient of its energy; between bodies it acts on the vertex and
/// on the three corners of the triangle it has passed, so that momentum is kept pair by pair. The springs begin 0.15
/// spacings outside the surface, for what is seen not to poke through; where a body starts closer than that, they begin
/// where it is. Particles that obstacles would reach through a crushed skin are kept out themselves.
///
/// Between bodies only vertices feel: an edge can enter a triangle between its corners, so surfaces should be about as
/// fine as their particles. A body touches itself only where at rest its surface was two spacings away or more.
const EffectInfo& contact_effect();

}  // namespace deforma
