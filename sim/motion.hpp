#pragma once

#include <span>
#include <vector>

#include "sim/state.hpp"

namespace deforma {

/// What of a state depends on where particles are and how they move: exchanged for another while forces are asked for
/// there.
struct Motion {
  std::vector<Vec3> displacement;      ///< [m]                                      n
  std::vector<Vec3> velocity;          ///< [m/s]                                    n
  std::vector<Mat3> F, F_rate;         ///< deformation gradient and its rate [1/s]  n
  std::vector<Vec3> position;          ///< of the surface vertices [m]              m
  std::vector<Vec3> surface_velocity;  ///< [m/s]                                    m

  /// Everything at rest at other places than the state's; F and the surface's positions are still to be found.
  /// @param elsewhere displacement of every particle [m]   n
  void rest_at(std::span<const Vec3> elsewhere, const State& state);

  /// Swaps all of it with the state's.
  void exchange(State& state);
};

}  // namespace deforma
