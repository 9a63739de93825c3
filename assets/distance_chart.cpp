#include "assets/distance_chart.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace deforma {

namespace {

constexpr double cube = 2.0;      // spacings
constexpr double farthest = 8.0;  // spacings
constexpr double least = 4096.0;  // cubes

}  // namespace

DistanceChart::DistanceChart(const MeshTree& tree, double spacing, std::size_t particles)
    : width_(cube * spacing) {
  if (tree.nodes().empty() || !(spacing > 0.0)) return;
  const Eigen::AlignedBox3d& box = tree.nodes().front().box;
  const double most = std::max(least, static_cast<double>(particles));
  auto cubes = [&] { return (box.sizes() / width_).array().floor() + 1.0; };
  while (cubes().prod() > most) width_ *= 1.1;  // of a body that fills little of its box
  start_ = box.min();
  count_ = cubes().cast<int>();
  distance_.resize(static_cast<std::size_t>(count_.prod()));
  tbb::parallel_for(0, count_.x(), [&](int x) {
    for (int y = 0; y < count_.y(); ++y)
      for (int z = 0; z < count_.z(); ++z) {
        const Eigen::Vector3d middle = start_ + width_ * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
        distance_[number_of({x, y, z})] = tree.distance(middle, farthest * spacing);
      }
  });
}

}  // namespace deforma
