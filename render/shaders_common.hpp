#pragma once

#include <string>

#include "render/quality.hpp"

namespace deforma {

/// The first lines of every shader: version, how many taps shadows take, the uniform block `Frame`.
std::string shader_head(bool sample_mask, const Detail& detail);

/// Tone map, dither and the picture's backdrop, for everything that writes colour.
std::string shader_color();

/// The colour of a body before any light: its own, or that of a value.
std::string shader_base_color();

/// Light that comes up from the floor, for vertex shaders.
std::string shader_floor_light();

/// Light that reaches bodies, and what they make of it. Needs shader_color.
std::string shader_light();

}  // namespace deforma
