#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/scene.hpp"

namespace deforma {

/// What a frame's PNG says of itself: Title, Software, Scene-SHA256, Frame (counted from 1) and Time [s]. The same at
/// every run, so that the same picture is the same file.
/// @param scene_hash of the resolved scene's text, which is that of scene.toml beside the frames
std::vector<std::pair<std::string, std::string>> frame_text(const Scene& scene, const std::string& scene_hash,
                                                            int frame);

}  // namespace deforma
