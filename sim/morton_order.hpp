#pragma once

#include <span>
#include <vector>

#include "sim/types.hpp"

namespace deforma {

/// The order of points along a Z-curve, so that what is near in space is near in memory.
///
/// The curve runs through 2^63 cubes of one size around the points; points in one cube keep their order. A function of
/// the points' places relative to their bounds alone: a body moved or scaled has the same order, but for points that
/// rounding takes across the side of a cube, and the sides lie where regular points do not.
/// Source: Morton, A computer oriented geodetic data base (1966).
///
/// @param points [m], finite   n
/// @return indices of the points, first to last on the curve   n
std::vector<Index> morton_order(std::span<const Vec3> points);

}  // namespace deforma
