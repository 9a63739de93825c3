#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Particles that are held, or moved as a rigid whole along keyframes, until they are let go. What a pin does
/// to them is no force: displacement and velocity are written after every integration.
const EffectInfo& pin_effect();

}  // namespace deforma
