#pragma once

#include <toml++/toml.h>

#include "pipeline/scene.hpp"

namespace deforma {

/// Puts a value from the command line into a parsed scene, making tables on the way where there are none;
/// whether the key is a valid one is for the reader to say.
/// @throws UserError when the path leads through a value, or to an element that a list does not have.
void apply_override(toml::table& scene, const Override& given);

}  // namespace deforma
