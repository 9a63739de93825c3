#include "sim/morton_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "fixtures.hpp"
#include "sim/rotation.hpp"

namespace deforma {
namespace {

std::vector<Vec3> scattered(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Vec3> points(count);
  for (Vec3& point : points)
    for (double& x : point) x = uniform(random);
  return points;
}

std::vector<Vec3> grid(Index count) {
  return lattice_particles(Vec3::Constant(1.0), count, count, count, 1000.0).particles.rest;
}

std::vector<Vec3> moved(std::vector<Vec3> points, double scale, const Vec3& shift) {
  for (Vec3& point : points) point = scale * point + shift;
  return points;
}

std::vector<Index> counting(std::size_t count) {
  std::vector<Index> numbers(count);
  std::iota(numbers.begin(), numbers.end(), Index{0});
  return numbers;
}

TEST(MortonOrder, NamesEveryPointOnce) {
  const std::vector<Vec3> points = scattered(5000);
  std::vector<Index> order = morton_order(points);
  EXPECT_NE(order, counting(points.size()));
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, counting(points.size()));
}

TEST(MortonOrder, WalksTheEightCornersOfACubeAsAZ) {
  std::vector<Vec3> corners;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) corners.emplace_back(x, y, z);
  EXPECT_THAT(morton_order(corners), testing::ElementsAre(0, 4, 2, 6, 1, 5, 3, 7));
}

// Every octant of the curve is walked to its end before the next begins.
TEST(MortonOrder, KeepsOctantsTogether) {
  const std::vector<Vec3> points = grid(16);
  const std::vector<Index> order = morton_order(points);
  auto octant = [&](std::size_t k) {
    const Vec3& p = points[order[k]];
    return (p.x() > 0.5) * 4 + (p.y() > 0.5) * 2 + (p.z() > 0.5);
  };
  for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(octant(k), static_cast<int>(k / 512)) << k;
}

TEST(MortonOrder, DoesNotDependOnScaleOrPlace) {
  for (const std::vector<Vec3>& points : {scattered(3000), grid(15), grid(16), grid(17), grid(20)}) {
    const std::vector<Index> order = morton_order(points);
    for (double scale : {1e-6, 0.37, 1e5})
      for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(1.7, -12.3, 7.1)})
        EXPECT_EQ(morton_order(moved(points, scale, scale * shift)), order)
            << scale << " " << shift.transpose();
  }
}

TEST(MortonOrder, LeavesPointsInOnePlaceAsTheyAre) {
  EXPECT_EQ(morton_order(std::vector<Vec3>(2000, Vec3(1, 2, 3))), counting(2000));
  EXPECT_TRUE(morton_order({}).empty());
}

}  // namespace
}  // namespace deforma
