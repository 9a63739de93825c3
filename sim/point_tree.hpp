#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/types.hpp"

namespace deforma {

/// A k-d tree over fixed points (nanoflann). Safe to query from several threads.
class PointTree {
 public:
  using Found = std::pair<Index, double>;  ///< index into the points, distance [m]

  /// @param points [m]; must outlive the tree
  explicit PointTree(std::span<const Vec3> points);
  ~PointTree();

  /// The `count` nearest points (fewer if there are fewer), nearest first.
  std::vector<Found> nearest(const Vec3& from, std::size_t count) const;

  /// Every point closer than `radius` [m], in no particular order.
  std::vector<Found> within(const Vec3& from, double radius) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace deforma
