#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sim/skin.hpp"
#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// A surface vertex and the triangles of one body that may be the closest to it before something has moved
/// far.
struct NearSurface {
  Index vertex;
  Index body;                    ///< whose triangles: another body, or the vertex's own
  std::vector<Index> triangles;  ///< ascending
};

/// How far to look for what is near.
struct NearSettings {
  double depth;      ///< how deep inside a vertex still counts [m]
  double margin;     ///< how far anything may move before the search is repeated [m]
  double exclusion;  ///< triangles of the vertex's own body closer than this at rest are its neighbours [m]
};

/// Finds the vertices of body `a` near the surface of body `b` (or of `a` itself).
///
/// Within one body only triangles that the vertex stands in front of count, or those it has touched already:
/// behind it is its own inside.
/// @param points   where every vertex is now [m]                                                m
/// @param touching whether a vertex touches body b already; asked only when a is b
/// @param near     appended to, ascending by vertex
/// @return how far both may move before a vertex that was not appended can touch [m]
double find_near_surfaces(const State& state, std::span<const Vec3> points, Index a, Index b,
                          const NearSettings& settings, const std::function<bool(Index vertex)>& touching,
                          std::vector<NearSurface>& near);

/// A vertex inside another surface.
struct Penetration {
  double depth;    ///< distance to the surface [m]
  Vec3 normal;     ///< unit, the shortest way out: minus the gradient of the depth with respect to the vertex
  Index triangle;  ///< the closest
  Vec3 barycentric;  ///< of the closest point: times `normal`, the gradient with respect to its corners
};

/// Where the vertex is inside, no deeper than `depth`, or outside, closer than `reach` [m]. Reads the surface's current
/// positions.
///
/// The side is told by the angle-weighted normal of the triangles that share the closest point (Baerentzen &
/// Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005).
std::optional<Penetration> find_penetration(const Surface& surface, const NearSurface& near, double depth,
                                            double reach);

}  // namespace deforma
