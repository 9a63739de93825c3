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

  /// Writes the `count` nearest points, at least 1 (fewer if there are fewer), nearest first.
  void nearest(const Vec3& from, std::size_t count, std::vector<Found>& found) const;

  /// Writes every point closer than `radius` [m], in no particular order.
  void within(const Vec3& from, double radius, std::vector<Found>& found) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace deforma
