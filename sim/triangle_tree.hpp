#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <span>
#include <vector>

#include "sim/skin.hpp"
#include "sim/types.hpp"

namespace deforma {

/// Barycentric coordinates of the point of triangle abc closest to p; they are exactly zero off the closest
/// feature. A triangle without area answers with the closest point of its longest side. Source: Ericson,
/// Real-Time Collision Detection (2005), section 5.1.5.
Vec3 closest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Angle of the corner at a in triangle abc [rad], zero where a side has no length.
double corner_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// The place on a triangle set nearest to a point.
struct Closest {
  static constexpr Index none = std::numeric_limits<Index>::max();

  Index triangle = none;  ///< `none` when nothing is within reach
  Vec3 barycentric = Vec3::Zero();
  Vec3 point = Vec3::Zero();                                  ///< [m]
  double distance = std::numeric_limits<double>::infinity();  ///< [m]
};

/// A tree of bounding boxes over triangles, for what is near a point.
///
/// Keeps a copy of the corners, so that the mesh may move on afterwards. Equal distances go to the lower
/// index.
class TriangleTree {
 public:
  /// @throws std::invalid_argument when a triangle names a point that is not there.
  TriangleTree(std::span<const Vec3> points, std::span<const Triangle> triangles);

  /// The closest place no further away than `reach` [m].
  Closest closest(const Vec3& point, double reach = std::numeric_limits<double>::infinity()) const;

  /// Appends every triangle no further away than `reach` [m], ascending.
  void within(const Vec3& point, double reach, std::vector<Index>& triangles) const;

  std::size_t bytes() const;

 private:
  struct Node {
    Vec3 low, high;
    Index first;  ///< a leaf's first entry of order_, an inner node's second child
    Index count;  ///< a leaf's entries, zero for an inner node
  };
  struct Corners {
    Vec3 a, b, c;
  };

  Index build(Index begin, Index end, std::span<const Vec3> centers);

  std::vector<Node> nodes_;       ///< an inner node's first child follows it
  std::vector<Index> order_;      ///< triangles, leaf by leaf
  std::vector<Corners> corners_;  ///< of each triangle
};

}  // namespace deforma
