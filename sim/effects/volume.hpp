#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Resistance to volume change: Psi = kv/2 (J - 1)^2, P = kv (J - 1) cof F (paper eqs 18, 19, with the
/// reaction on the neighbours that they leave out). Acts like an addition to Lamé's lambda.
const EffectInfo& volume_effect();

}  // namespace deforma
