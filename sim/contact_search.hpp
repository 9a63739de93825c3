#pragma once

#include <functional>
#include <span>
#include <vector>

#include "sim/near_surfaces.hpp"
#include "sim/obstacle_motion.hpp"
#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// A body that can touch something.
struct ContactSide {
  Index body;
  bool bodies;  ///< other bodies that have this set, too
  bool self;    ///< itself
};

/// A surface vertex and what it may soon touch.
struct NearVertex {
  Index vertex;
  Index side;  ///< whose
  std::vector<Index> obstacles;
  std::vector<NearSurface> surfaces;
};

/// A particle and the obstacles that it may soon enter.
struct NearParticle {
  Index particle;
  Index side;
  std::vector<Index> obstacles;
};

struct ContactPlaces {
  std::vector<NearVertex> vertices;     ///< ascending by side, then vertex
  std::vector<NearParticle> particles;  ///< ascending by side, then particle
  double slack;  ///< how far anything may move before something not listed can touch [m]
};

/// How deep a vertex may be inside another body and still be pushed out, in spacings.
constexpr double deepest_contact = 1.0;

/// Looks at every vertex and particle of every side.
/// @param points   where every vertex is [m]                                                      m
/// @param touching whether a vertex touches its own body already
ContactPlaces find_contact_places(const State& state, std::span<const Vec3> points,
                                  std::span<const ContactSide> sides,
                                  std::span<const ObstacleMotion> obstacles,
                                  const std::function<bool(Index vertex)>& touching);

}  // namespace deforma
