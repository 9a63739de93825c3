#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace deforma {

/// Cuts a polygon, concave or not quite flat, into corners - 2 triangles that turn the same way as it does.
///
/// Cuts off one ear after the other, the one with the shortest cut first, seen along the polygon's mean normal. Where
/// there is no ear left (the outline crosses itself) the remaining corner that bulges most is cut off.
/// Source: Meisters 1975, "Polygons have ears".
/// @return indices into `corners`; nothing for fewer than three corners
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Eigen::Vector3d> corners);

}  // namespace deforma
