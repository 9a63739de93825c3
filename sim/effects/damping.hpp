#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Takes kinetic energy away. `rate` slows every particle, dv/dt = -rate v, integrated implicitly: v / (1 +
/// rate dt). `viscosity` resists only deformation, S = viscosity * dE_G/dt with E_G the Green strain: P = F
/// S, no torque, no force under rigid motion, power -viscosity |dE_G/dt|^2 V.
const EffectInfo& damping_effect();

}  // namespace deforma
