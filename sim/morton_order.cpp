#include "sim/morton_order.hpp"

#include <tbb/parallel_sort.h>

#include <utility>

#include "sim/parallel.hpp"

namespace deforma {

namespace {

constexpr int bits = 21;  // per axis: three fill a key
// The cubes stick out by these shares of the widest extent. Points of a lattice lie at whole fractions of it: with
// irrational shares the sides of the larger cubes pass between them.
constexpr double before = 0.0381966011250105;  // (3 - sqrt 5) / 20
constexpr double behind = 0.0414213562373095;  // (sqrt 2 - 1) / 10

/// The lowest 21 bits, each moved to three times its place.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

}  // namespace

std::vector<Index> morton_order(std::span<const Vec3> points) {
  std::vector<Index> order(points.size());
  if (points.empty()) return order;
  Vec3 low = points.front(), high = low;
  for (const Vec3& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double extent = (high - low).maxCoeff();
  const double cubes =
      extent > 0.0 ? static_cast<double>(1u << bits) / ((1.0 + before + behind) * extent) : 0.0;
  std::vector<std::pair<std::uint64_t, Index>> keys(points.size());
  parallel_for_each(points.size(), [&](std::size_t i) {
    const Vec3 place = cubes * ((points[i] - low).array() + before * extent);
    const auto cube = place.cast<std::uint64_t>().eval();
    keys[i] = {spread(cube.x()) << 2 | spread(cube.y()) << 1 | spread(cube.z()), static_cast<Index>(i)};
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].second;
  return order;
}

}  // namespace deforma
