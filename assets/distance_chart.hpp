#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "assets/mesh_tree.hpp"

namespace deforma {

/// Distances from the triangles of a mesh to the points of a coarse grid, from which a lower bound follows for any
/// point between them without asking the tree: a distance changes no faster than its point moves.
class DistanceChart {
 public:
  /// Knows nothing: every bound is 0.
  DistanceChart() = default;

  /// @param spacing of the particles that the bounds will be asked for [m]; what is farther than eight of them counts as
  ///                so far
  /// @param particles how many there are; the grid has no more points, or 4096
  DistanceChart(const MeshTree& tree, double spacing, std::size_t particles);

  /// A distance [m] that the point is at least away from every triangle, by more than rounding; 0 where nothing is
  /// known.
  double at_least(const Eigen::Vector3d& point) const {
    if (distance_.empty()) return 0.0;
    const Eigen::Vector3d place = (point - start_) / width_;
    if (!((place.array() >= 0.0).all() && (place.array() < count_.cast<double>()).all())) return 0.0;
    const Eigen::Array3i cube = place.array().cast<int>();
    const double away = (place - (cube.cast<double>() + 0.5).matrix()).norm();
    return std::max(0.0, distance_[number_of(cube)] - width_ * (away + margin));
  }

 private:
  static constexpr double margin = 1e-6;  // cubes: what is closer to a tie is asked exactly

  std::size_t number_of(const Eigen::Array3i& cube) const {
    return (static_cast<std::size_t>(cube.x()) * static_cast<std::size_t>(count_.y()) +
            static_cast<std::size_t>(cube.y())) *
               static_cast<std::size_t>(count_.z()) +
           static_cast<std::size_t>(cube.z());
  }

  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();
  double width_ = 0.0;  // of a cube [m]
  Eigen::Array3i count_ = Eigen::Array3i::Zero();
  std::vector<double> distance_;  // of the cubes' middles [m]
};

}  // namespace deforma
