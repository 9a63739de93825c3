#include "assets/weld.hpp"

#include <random>

#include "assets/shapes.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;

/// Every triangle with three points of its own.
Mesh exploded(const Mesh& mesh) {
  Mesh soup;
  for (const auto& t : mesh.triangles) {
    auto first = static_cast<std::uint32_t>(soup.points.size());
    for (std::uint32_t corner : t) soup.points.push_back(mesh.points[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

TEST(Weld, PutsASoupTogetherAgainWhereverItLies) {
  for (double away : {0.0, 1e4})
    for (double size : {1e-3, 1.0, 1e3}) {
      Mesh sphere = moved(make_sphere(size, 12), Vector3d::Constant(away * size));
      Mesh soup = exploded(sphere);
      WeldReport report = weld(soup);
      EXPECT_EQ(soup.points.size(), sphere.points.size());
      EXPECT_EQ(report.welded_points, 3 * sphere.triangles.size() - sphere.points.size());
      EXPECT_EQ(report.dropped_triangles, 0u);
      EXPECT_EQ(inspect(soup).boundary_edges, 0u);
    }
}

TEST(Weld, ForgivesRoundingButKeepsSmallFeatures) {
  Mesh soup = exploded(make_box({1, 1, 1}, 4));
  std::mt19937 random(7);
  for (Vector3d& p : soup.points)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] += 2e-7 * (static_cast<double>(random() % 1000) / 500.0 - 1.0);
  weld(soup);
  EXPECT_EQ(inspect(soup).boundary_edges, 0u);
  EXPECT_EQ(soup.points.size(), make_box({1, 1, 1}, 4).points.size());

  Mesh fine = merged(make_box({1, 1, 1}, 1), make_octahedron(1e-4, 1));
  EXPECT_EQ(weld(fine).welded_points, 0u);
}

TEST(Weld, DropsTrianglesWithoutAreaAndPointsWithoutTriangle) {
  Mesh mesh = make_octahedron(1, 1);
  mesh.points.insert(mesh.points.begin(), Vector3d(9, 9, 9));
  for (auto& t : mesh.triangles)
    for (auto& corner : t) ++corner;
  mesh.points.push_back(0.5 * (mesh.points[1] + mesh.points[2]));
  mesh.triangles.push_back({1, 1, 2});
  mesh.triangles.push_back({1, 2, 7});
  WeldReport report = weld(mesh);
  EXPECT_EQ(report.dropped_triangles, 2u);
  EXPECT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.triangles.size(), 8u);
  EXPECT_NEAR(inspect(mesh).volume, 4.0 / 3.0, 1e-14);
}

TEST(Weld, LeavesNothingOfAPoint) {
  Mesh mesh{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}};
  EXPECT_EQ(weld(mesh).dropped_triangles, 1u);
  EXPECT_TRUE(mesh.points.empty());
}

}  // namespace
}  // namespace deforma
