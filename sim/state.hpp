#pragma once

#include <vector>

#include "sim/moving_least_squares.hpp"
#include "sim/neighborhood.hpp"
#include "sim/obstacle.hpp"
#include "sim/particles.hpp"
#include "sim/skin.hpp"
#include "sim/types.hpp"

namespace deforma {

/// Everything that is simulated: what it consists of, fixed when built, and how it stands now.
struct State {
  Particles particles;
  std::vector<Body> bodies;
  Neighborhood links;
  MovingLeastSquares fit;
  Surface surface;
  std::vector<Obstacle> obstacles;

  double time = 0.0;                ///< [s]
  std::vector<Mat3> F;              ///< deformation gradient                                 n
  std::vector<Mat3> F_rate;         ///< its rate [1/s], when some effect needs it            n
  std::vector<std::uint8_t> fixed;  ///< 1 where a pin prescribes the motion                  n

  std::size_t size() const { return particles.size(); }
};

/// Builds what follows from particles and bodies: links, moments, skin, and zeroed state arrays.
/// @param state  `particles`, `bodies` and `surface` (rest, triangles, body) are given; the rest is written
void prepare_state(State& state, const NeighborhoodSettings& settings, const LinkFilter& link_allowed = {},
                   const LinkFilter& tie_allowed = {}, Gradient gradient = Gradient::linear);

/// Fits the gradients anew, after volumes were changed.
void refit(State& state, Gradient gradient);

}  // namespace deforma
