#pragma once

#include <functional>
#include <span>
#include <vector>

#include "sim/types.hpp"

namespace deforma {

/// Finds the highest natural frequency of a system of particles from its force alone.
///
/// Power iteration on M^-1 K, with K w taken as the one-sided difference of the force along w. The mode found
/// is kept, so that a later measurement of a slightly changed system starts close and takes few iterations.
/// An iteration that ends early underestimates by a few per cent: the step fraction leaves room for it.
class StiffnessProbe {
 public:
  /// Internal force [N] at a displacement field [m]; both n.
  using Force = std::function<void(std::span<const Vec3> displacement, std::span<Vec3> force)>;

  /// @param displacement where to measure [m]                     n
  /// @param mass [kg]                                             n
  /// @param fixed 1 where the particle cannot move                n
  /// @param scale length of a typical displacement difference [m]: the spacing
  /// @return omega_max [rad/s]; 0 when no force answers any displacement
  double measure(std::span<const Vec3> displacement, std::span<const double> mass,
                 std::span<const std::uint8_t> fixed, double scale, const Force& force);

  /// What a measurement holds for, per body: how much its strain has stiffened it, up to a factor of its own, and the
  /// effects' stiffness keys.
  struct Conditions {
    std::vector<double> stiffening, key;
  };

  /// Whether the last measurement, made under other conditions, no longer holds.
  bool stale(const Conditions& now) const;
  void remember(const Conditions& now) { then_ = now; }

 private:
  Conditions then_;
  std::vector<Vec3> mode_;
};

}  // namespace deforma
