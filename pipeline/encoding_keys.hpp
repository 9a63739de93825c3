#pragma once

#include <toml++/toml.h>

#include "pipeline/scene.hpp"
#include "render/encoding.hpp"

namespace deforma {

/// What the scene asks of its video's encoder.
EncodingRequest encoding_request(const OutputSpec& output);

/// Fills in how the video is encoded where the scene does not say; a transparent one goes into mov then, as mp4 holds
/// none.
/// @param scene as it was parsed, for the place that a message names
/// @throws UserError for what the encoder does not take, with what it takes and the nearest name; std::runtime_error when
///         there is no encoder.
void resolve_encoding(const toml::table& scene, OutputSpec& output);

}  // namespace deforma
