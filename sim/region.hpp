#pragma once

#include <limits>

#include "sim/types.hpp"

namespace deforma {

/// A part of space that selects particles or surface vertices by their rest position: the box [min, max],
/// and within it, when a radius is given, the ball around a center. Everything by default.
struct Region {
  Vec3 min = Vec3::Constant(-std::numeric_limits<double>::infinity());  ///< [m]
  Vec3 max = Vec3::Constant(std::numeric_limits<double>::infinity());   ///< [m]
  Vec3 center = Vec3::Zero();                                           ///< [m]
  double radius = std::numeric_limits<double>::infinity();              ///< [m]

  bool contains(const Vec3& point) const {
    return (point.array() >= min.array()).all() && (point.array() <= max.array()).all() &&
           (point - center).norm() <= radius;
  }
};

}  // namespace deforma
