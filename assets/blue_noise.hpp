#pragma once

#include <Eigen/Core>
#include <vector>

#include "assets/solid.hpp"

namespace deforma {

/// Exactly `count` points inside the solid, irregular but evenly apart, the same every time: weighted elimination of a
/// five times larger random set. They keep 0.3 (V / count)^(1/3) from the surface where the solid is thick enough.
/// Source: Yuksel 2015, "Sample elimination for generating Poisson disk sample sets", section 3.
/// @param count above 0; the solid has a volume
/// @throws std::runtime_error when too little of the bounds is inside to find so many.
std::vector<Eigen::Vector3d> blue_noise(const Solid& solid, std::size_t count);

}  // namespace deforma
