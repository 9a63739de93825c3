#pragma once

#include "pipeline/scene.hpp"
#include "render/camera.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Fills in the camera that the scene leaves open: it looks at every visible body where it begins, every
/// visible obstacle that has an end, along its keyframes, and the ground below them.
/// @throws UserError when in some frame the camera stands in its target or looks along its own up direction.
void frame_scene(Scene& scene, const State& state);

/// Where the camera stands at a time [s]. @param spec as `frame_scene` leaves it
Camera camera_at(const CameraSpec& spec, double time);

}  // namespace deforma
