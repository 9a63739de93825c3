#include "assets/distance_chart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "assets/shapes.hpp"
#include "assets/solid.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> places(std::size_t count, double reach) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<Vector3d> points(count);
  for (Vector3d& point : points)
    for (double& x : point) x = uniform(random);
  return points;
}

TEST(DistanceChart, GivesALowerBoundThatIsWorthHaving) {
  for (const Mesh& mesh :
       {make_ellipsoid({1, 1, 1}, 12), make_torus(1.0, 0.4, 24, 12), make_box({2, 1, 0.5}, 3)}) {
    const MeshTree tree(mesh);
    const DistanceChart chart(tree, 0.05, 30000);
    const double coarse =
        0.1 * std::sqrt(3.0);  // a point is half a cube's diagonal from its middle, and so is its bound
    int known = 0;
    for (const Vector3d& point : places(3000, 1.5)) {
      const double bound = chart.at_least(point), distance = tree.distance(point, 10.0);
      EXPECT_GE(bound, 0.0);
      EXPECT_LE(bound, distance);
      if (bound == 0.0) continue;
      ++known;
      EXPECT_GE(bound, std::min(distance, 0.4 - 0.5 * coarse) - coarse - 1e-6);
    }
    EXPECT_GT(known, 20);
  }
}

TEST(DistanceChart, KnowsNothingOutsideOrUntilItIsMade) {
  const MeshTree tree(make_ellipsoid({1, 1, 1}, 12));
  EXPECT_EQ(DistanceChart().at_least(Vector3d(5, 0, 0)), 0.0);
  EXPECT_EQ(DistanceChart(tree, 0.1, 1000).at_least(Vector3d(5, 0, 0)), 0.0);
  EXPECT_EQ(DistanceChart(tree, 0.0, 0).at_least(Vector3d(0, 0, 0)), 0.0);
}

TEST(DistanceChart, ChangesNoAnswerOfASolid) {
  const Mesh mesh = make_torus(1.0, 0.4, 24, 12);
  Solid charted(mesh);
  const Solid plain(mesh);
  charted.chart_distances(0.08, 5000);
  for (double limit : {0.001, 0.1, 0.3, 5.0})
    for (const Vector3d& point : places(2000, 1.5))
      EXPECT_EQ(charted.distance(point, limit), plain.distance(point, limit));
}

}  // namespace
}  // namespace deforma
