#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "sim/types.hpp"

namespace deforma {

/// The rotation about `vector` by its length [rad].
inline Mat3 rotation_matrix(const Vec3& vector) {
  double angle = vector.norm();
  if (angle == 0.0) return Mat3::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

/// Angular velocity [rad/s] of a rotation vector that changes at `rate`: w with dR/dt = w x R.
///
/// The left Jacobian of the exponential map; equal to `rate` when the axis does not turn.
inline Vec3 angular_velocity(const Vec3& vector, const Vec3& rate) {
  double angle = vector.norm();
  if (angle < 1e-6) return rate + 0.5 * vector.cross(rate);
  Vec3 axis = vector / angle;
  double s = std::sin(angle) / angle;
  return s * rate + (1.0 - s) * axis.dot(rate) * axis + (1.0 - std::cos(angle)) / angle * axis.cross(rate);
}

}  // namespace deforma
