#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Elastic stress from the deformation gradient (paper eqs 4, 5, 17; sim/material.hpp). Neighbourhoods that
/// span only a plane or a line answer as a membrane or a rope, whatever the material.
const EffectInfo& elastic_effect();

}  // namespace deforma
