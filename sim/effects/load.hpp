#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// A given force on a part of a body's surface: in total, shared out by rest area, or per rest area. It does
/// not turn with the body; its energy is -f u.
const EffectInfo& load_effect();

}  // namespace deforma
