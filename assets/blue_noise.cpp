#include "assets/blue_noise.hpp"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <random>
#include <stdexcept>
#include <unordered_map>

namespace deforma {

namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr std::size_t oversampling = 5;
constexpr double clearance = 0.3;  // of the spacing, to the surface

/// Random points inside, at least `count`, with a share near the surface left out.
Points candidates(const Solid& solid, std::size_t count, double spacing) {
  const MeshFacts& facts = solid.facts();
  Vector3d size = facts.max - facts.min;
  auto batch = static_cast<std::size_t>(static_cast<double>(count) * size.prod() / solid.volume()) + 64;
  std::mt19937_64 random(1);
  // Written out, because the library's distributions differ between compilers.
  auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };

  Points inside;
  std::vector<double> depth;
  for (int tries = 0; inside.size() < 2 * count; ++tries) {
    if (tries == 64)
      throw std::runtime_error(fmt::format("particles: found only {} places for {} particles in the mesh",
                                           inside.size(), count / oversampling));
    Points tried(batch);
    for (Vector3d& p : tried)
      for (int axis = 0; axis < 3; ++axis) p[axis] = facts.min[axis] + size[axis] * uniform();
    std::vector<double> away(batch, 0.0);
    tbb::parallel_for(std::size_t{0}, batch, [&](std::size_t i) {
      if (solid.contains(tried[i])) away[i] = solid.distance(tried[i], spacing);
    });
    for (std::size_t i = 0; i < batch; ++i)
      if (away[i] > 0.0) {
        inside.push_back(tried[i]);
        depth.push_back(away[i]);
      }
  }

  // Where the solid is thinner than the clearance the deeper half has to do.
  std::vector<double> sorted = depth;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  double least = std::min(clearance * spacing, sorted[sorted.size() / 2]);
  Points deep;
  for (std::size_t i = 0; i < inside.size(); ++i)
    if (depth[i] >= least) deep.push_back(inside[i]);
  return deep;
}

/// Points in cubic cells as wide as the reach, in compressed rows.
class CellList {
 public:
  CellList(const Points& points, const Vector3d& origin, double width) : origin_(origin), width_(width) {
    for (std::size_t i = 0; i < points.size(); ++i) cells_[key_of(points[i], 0, 0, 0)].push_back(i);
  }

  template <typename Visit>
  void near(const Vector3d& p, const Visit& visit) const {
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (auto cell = cells_.find(key_of(p, x, y, z)); cell != cells_.end())
            for (std::size_t i : cell->second) visit(i);
  }

 private:
  std::uint64_t key_of(const Vector3d& p, int x, int y, int z) const {
    Eigen::Matrix<std::int64_t, 3, 1> cell = ((p - origin_) / width_).array().floor().cast<std::int64_t>();
    auto part = [](std::int64_t value) { return static_cast<std::uint64_t>(value + 1) & 0x1fffff; };
    return part(cell.x() + x) | part(cell.y() + y) << 21 | part(cell.z() + z) << 42;
  }

  Vector3d origin_;
  double width_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

}  // namespace

Points blue_noise(const Solid& solid, std::size_t count) {
  double spacing = std::cbrt(solid.volume() / static_cast<double>(count));
  Points points = candidates(solid, oversampling * count, spacing);

  // Twice the radius at which `count` balls fill the volume as densely as balls can (eq 3).
  double reach = 2.0 * std::cbrt(solid.volume() / (4.0 * std::numbers::sqrt2 * static_cast<double>(count)));
  CellList cells(points, solid.facts().min, reach);
  auto crowding = [&](std::size_t i, std::size_t j) {
    double near = 1.0 - (points[i] - points[j]).norm() / reach;
    return near > 0.0 && i != j ? std::pow(near, 8.0) : 0.0;
  };

  std::vector<double> weight(points.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    cells.near(points[i], [&](std::size_t j) { weight[i] += crowding(i, j); });
  });
  // Weights only fall, so an entry that promises more than its point has left is put back with what it has.
  std::priority_queue<std::pair<double, std::size_t>> crowded;
  for (std::size_t i = 0; i < points.size(); ++i) crowded.emplace(weight[i], i);
  std::vector<char> kept(points.size(), 1);
  for (std::size_t left = points.size(); left > count;) {
    auto [promised, i] = crowded.top();
    crowded.pop();
    if (promised != weight[i]) {
      crowded.emplace(weight[i], i);
      continue;
    }
    kept[i] = 0;
    --left;
    cells.near(points[i], [&](std::size_t j) {
      if (kept[j]) weight[j] -= crowding(i, j);
    });
  }
  Points rest;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (kept[i]) rest.push_back(points[i]);
  return rest;
}

}  // namespace deforma
