#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "sim/types.hpp"

namespace deforma {

/// The spring that keeps surfaces apart. It begins `shell` spacings outside and is linear at first, stiffer the deeper
/// they are,
///     E = k x^2/2 (1 + (x/a)^2/2),   a = `stiffening` spacings,
/// so that gentle contact costs no small steps, and a violent one, whose steps its speed makes small anyway, is not
/// seen to go far through the surface.
struct Penalty {
  static constexpr double shell = 0.15;
  static constexpr double stiffening = 0.06;

  double stiffness;  ///< k where it begins [N/m]
  double spacing;    ///< of the particles [m]

  double bend(double x) const {
    const double ratio = x / (stiffening * spacing);
    return ratio * ratio;
  }
  double energy(double x) const { return 0.5 * stiffness * x * x * (1.0 + 0.5 * bend(x)); }  ///< [J]
  double force(double x) const { return stiffness * x * (1.0 + bend(x)); }                   ///< [N]
  /// The speed over the frequency with which a mass must come to get so deep [m].
  double speed(double x) const { return x * std::sqrt(1.0 + 0.5 * bend(x)); }
  double stiffening_at(double x) const { return 1.0 + 3.0 * bend(x); }  ///< E'' over k
};

/// What part of the penalty force acts while the surfaces move at `velocity` [m/s] (positive: apart).
///
/// All of it while they close, e^2 of it while they separate: then a point mass leaves with e^2 of the energy
/// it came with, whatever the step. The change is spread over velocities up to `blend` [m/s], so that what
/// rests is damped and does not chatter. Never more than 1: it can only take energy.
inline double restitution_factor(double velocity, double restitution, double blend) {
  if (velocity <= 0.0) return 1.0;
  const double lost = 1.0 - restitution * restitution;
  return velocity < blend ? 1.0 - lost * velocity / blend : 1.0 - lost;
}

/// A sticking contact's tangential spring: how far it has been stretched since it took hold.
struct Slip {
  Index partner;     ///< what is touched: an obstacle, or a body
  Vec3 normal;       ///< when last seen
  Vec3 stretch;      ///< tangential [m]
  double stiffness;  ///< of the spring [N/m]

  double energy() const { return 0.5 * stiffness * stretch.squaredNorm(); }  // [J]
};

/// The spring of the same contact a substep ago, or a slack one: a container's walls are told apart by their normals.
inline Slip take_slip(std::span<const Slip> slips, Index partner, const Vec3& normal) {
  Slip best{partner, normal, Vec3::Zero(), 0.0};
  double alike = 0.7;  // cosine between the normals
  for (const Slip& slip : slips) {
    if (slip.partner != partner || slip.normal.dot(normal) <= alike) continue;
    alike = slip.normal.dot(normal);
    best.stretch = slip.stretch;
  }
  return best;
}

/// Coulomb friction: spring and damper in parallel, and never more than `limit` = mu times the normal force.
/// When they would give more, the contact slides and the spring is let out to what the limit can hold beside
/// the damper. Source: Cundall & Strack, A discrete numerical model for granular assemblies (1979).
/// @param slip     its stretch already follows the motion so far; projected and shortened here
/// @param velocity tangential, of the vertex relative to what it touches [m/s]
/// @param damping  [N s/m]
/// @return the force on the vertex [N]
inline Vec3 friction_force(Slip& slip, const Vec3& velocity, double damping, double limit) {
  slip.stretch -= slip.normal * slip.normal.dot(slip.stretch);
  const Vec3 trial = -slip.stiffness * slip.stretch - damping * velocity;
  const double size = trial.norm();
  if (size <= limit) return trial;
  const double held = std::max(0.0, limit - damping * velocity.norm());
  slip.stretch = -held / (slip.stiffness * size) * trial;  // never longer than before
  return limit / size * trial;
}

}  // namespace deforma
