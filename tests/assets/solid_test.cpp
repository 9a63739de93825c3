#include "assets/solid.hpp"

#include <cmath>
#include <random>

#include "assets/shapes.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Vector3d> random_points(std::size_t count, double reach) {
  std::mt19937 random(3);
  std::vector<Vector3d> points(count);
  for (Vector3d& p : points)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = reach * (static_cast<double>(random()) / 2147483648.0 - 1.0);
  return points;
}

TEST(WindingNumber, IsOneInsideAndZeroOutsideAClosedMesh) {
  MeshTree tree(make_torus(1, 0.4, 64, 32));
  WindingNumber winding(tree);
  for (const Vector3d& p : random_points(4000, 1.6)) {
    double tube = std::hypot(std::hypot(p.x(), p.y()) - 1.0, p.z());
    if (std::abs(tube - 0.4) < 0.01) continue;
    EXPECT_NEAR(winding.at(p), tube < 0.4 ? 1.0 : 0.0, 0.01) << p.transpose();
  }
}

TEST(WindingNumber, BlendsAcrossAHole) {
  Mesh box = make_box({1, 1, 1}, 8);
  std::erase_if(box.triangles, [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](auto i) { return box.points[i].z() > 0.499; });
  });
  MeshTree tree(box);
  WindingNumber winding(tree);
  EXPECT_NEAR(winding.at({0, 0, 0}), 5.0 / 6.0, 0.01);
  EXPECT_NEAR(winding.at({0, 0, 0.5}), 0.5,
              0.01);  // in the plane of the hole the box fills the lower half of sight
}

TEST(MeshTree, DistanceIsThatOfTheNearestTriangle) {
  MeshTree tree(make_box({2, 2, 2}, 7));
  for (const Vector3d& p : random_points(500, 2.0)) {
    Vector3d beyond = (p.cwiseAbs().array() - 1.0).matrix();
    double expected = beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : -beyond.maxCoeff();
    EXPECT_NEAR(tree.distance(p, 100.0), expected, 1e-12);
    EXPECT_NEAR(tree.distance(p, 0.3), std::min(expected, 0.3), 1e-12);
  }
}

TEST(Solid, ColumnsAgreeWithWindingNumbers) {
  for (const Mesh& mesh :
       {make_torus(1, 0.4, 24, 12), merged(make_sphere(1, 6), flipped(make_sphere(0.5, 6))),
        merged(make_sphere(1, 6), moved(make_sphere(1, 6), {0.5, 0, 0}))}) {
    Solid solid(mesh);
    MeshTree tree(mesh);
    WindingNumber winding(tree);
    std::vector<char> inside(60);
    for (const Vector3d& p : random_points(60, 1.5)) {
      solid.mark_column(p.x(), p.y(), -1.51, 0.05, inside);
      for (std::size_t k = 0; k < inside.size(); ++k) {
        Vector3d at(p.x(), p.y(), -1.51 + 0.05 * static_cast<double>(k));
        EXPECT_EQ(inside[k] != 0, std::abs(winding.at(at)) > 0.5) << at.transpose();
        EXPECT_EQ(inside[k] != 0, solid.contains(at)) << at.transpose();
      }
    }
  }
}

TEST(Solid, ColumnsThroughEdgesAndCornersLoseNothing) {
  // Lines exactly through the corners, the edges and the diagonals that the triangles share.
  Solid box(make_box({2, 2, 2}, 4)), octahedron(make_octahedron(1, 4));
  std::vector<char> inside(7);
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j) {
      double x = 0.25 * i, y = 0.25 * j;
      box.mark_column(x, y, -0.9, 0.3, inside);
      EXPECT_EQ(std::count(inside.begin(), inside.end(), 1), 7) << i << " " << j;
      octahedron.mark_column(x, y, -0.99, 0.33, inside);
      for (int k = 0; k < 7; ++k) {
        double beyond = std::abs(x) + std::abs(y) + std::abs(-0.99 + 0.33 * k) - 1.0;
        if (std::abs(beyond) > 1e-9) {
          EXPECT_EQ(inside[k] != 0, beyond < 0.0) << i << " " << j << " " << k;
        }
      }
    }
}

TEST(Solid, VolumeOfPlainMeshesIsExactAndWithoutWarning) {
  Mesh hollow = merged(make_box({2, 2, 2}, 2), flipped(make_box({1, 1, 1}, 2)));
  for (const auto& [mesh, volume] : {std::pair{make_box({1, 2, 3}, 3), 6.0},
                                     {hollow, 7.0},
                                     {flipped(hollow), 7.0},
                                     {flipped(make_octahedron(1, 3)), 4.0 / 3.0}}) {
    Solid solid(mesh);
    EXPECT_NEAR(solid.volume(), volume, 1e-12);
    EXPECT_THAT(solid.warnings(), IsEmpty());
  }
}

TEST(Solid, OverlapsAreFilledOnce) {
  Solid solid(merged(make_box({2, 2, 2}, 2), moved(make_box({2, 2, 2}, 3), {1, 0.3, 0})));
  EXPECT_NEAR(solid.volume(), 16.0 - 1.0 * 1.7 * 2.0, 0.02 * 12.6);
  EXPECT_THAT(solid.warnings(), Contains(HasSubstr("overlap")));
}

TEST(Solid, PartsFacingInwardsCountAsTheirTwins) {
  Solid solid(merged(make_box({2, 2, 2}, 2), moved(flipped(make_box({1, 1, 1}, 2)), {3, 0, 0})));
  EXPECT_NEAR(solid.volume(), 9.0, 0.02 * 9.0);
  EXPECT_TRUE(solid.contains({3, 0, 0}));
}

TEST(Solid, AnOpenMeshIsCountedWithAWarning) {
  Mesh box = make_box({1, 1, 1}, 10);
  box.triangles.erase(box.triangles.begin(), box.triangles.begin() + 20);
  Solid solid(box);
  EXPECT_NEAR(solid.volume(), 1.0, 0.02);
  EXPECT_THAT(solid.warnings(), Contains(HasSubstr("boundary edges")));
}

TEST(Solid, FinsAreToldOf) {
  Mesh fin = make_octahedron(1, 1);
  fin.points.push_back({2, 2, 0});
  fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], 6});
  EXPECT_THAT(Solid(fin).warnings(), Contains(HasSubstr("1 edges where more than two triangles meet")));
}

}  // namespace
}  // namespace deforma
