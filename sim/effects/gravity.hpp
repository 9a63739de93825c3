#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Uniform gravity: f_i = m_i g, energy -m_i g . (u_i): the zero of the energy is the rest configuration, so
/// that its digits do not depend on where the origin is.
const EffectInfo& gravity_effect();

}  // namespace deforma
