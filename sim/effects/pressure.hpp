#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Uniform outside pressure on a body's surface, as of the air around it: -p times the gradient of the
/// enclosed volume, one third of each triangle's area vector per corner. Its energy is p V (exact for closed
/// surfaces).
const EffectInfo& pressure_effect();

}  // namespace deforma
