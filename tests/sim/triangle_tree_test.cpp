#include "sim/triangle_tree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <random>

#include "sphere_mesh.hpp"

namespace deforma {
namespace {

class Random {
 public:
  double in(double a, double b) { return a + (b - a) * (generator_() / 4294967296.0); }
  Vec3 point(double reach) { return {in(-reach, reach), in(-reach, reach), in(-reach, reach)}; }

 private:
  std::mt19937 generator_{5};
};

TEST(TriangleTree, ClosestPointOfATriangleIsNoFurtherThanAnyOther) {
  Random random;
  for (int k = 0; k < 500; ++k) {
    Vec3 a = random.point(1), b = random.point(1), c = random.point(1), p = random.point(2);
    Vec3 w = closest_barycentric(p, a, b, c);
    EXPECT_NEAR(w.sum(), 1.0, 1e-12);
    EXPECT_GE(w.minCoeff(), 0.0);
    double distance = (p - w[0] * a - w[1] * b - w[2] * c).norm();
    for (int i = 0; i <= 40; ++i)
      for (int j = 0; i + j <= 40; ++j) {
        Vec3 q = (i * a + j * b + (40 - i - j) * c) / 40.0;
        ASSERT_LE(distance, (p - q).norm() + 1e-12);
      }
  }
}

TEST(TriangleTree, ATriangleWithoutAreaIsItsLongestSide) {
  Vec3 a(0, 0, 0), b(1, 0, 0), c(3, 0, 0);
  Vec3 w = closest_barycentric(Vec3(2, 1, 0), a, b, c);
  EXPECT_LT((w[0] * a + w[1] * b + w[2] * c - Vec3(2, 0, 0)).norm(), 1e-14);
  w = closest_barycentric(Vec3(2, 1, 0), a, a, a);
  EXPECT_DOUBLE_EQ(w.sum(), 1.0);
}

TEST(TriangleTree, FindsWhatTryingEveryTriangleFinds) {
  Random random;
  MeshShape mesh = sphere_mesh(1.0, 3);
  TriangleTree tree(mesh.points, mesh.triangles);
  for (int k = 0; k < 300; ++k) {
    Vec3 p = random.point(1.5);
    double nearest = 1e9, reach = random.in(0.05, 1.0);
    std::vector<Index> near;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      Vec3 w = closest_barycentric(p, mesh.points[a], mesh.points[b], mesh.points[c]);
      double distance = (p - w[0] * mesh.points[a] - w[1] * mesh.points[b] - w[2] * mesh.points[c]).norm();
      nearest = std::min(nearest, distance);
      if (distance <= reach) near.push_back(t);
    }
    Closest found = tree.closest(p);
    EXPECT_NEAR(found.distance, nearest, 1e-14);
    EXPECT_NEAR((p - found.point).norm(), nearest, 1e-14);
    EXPECT_EQ(tree.closest(p, 0.99 * nearest).triangle, Closest::none);
    std::vector<Index> listed;
    tree.within(p, reach, listed);
    EXPECT_EQ(listed, near);
  }
}

TEST(TriangleTree, AnEmptyOneFindsNothing) {
  TriangleTree tree({}, {});
  EXPECT_EQ(tree.closest(Vec3::Zero()).triangle, Closest::none);
}

TEST(TriangleTree, CornerAnglesAddUp) {
  Random random;
  Vec3 a = random.point(1), b = random.point(1), c = random.point(1);
  EXPECT_NEAR(corner_angle(a, b, c) + corner_angle(b, c, a) + corner_angle(c, a, b), std::numbers::pi, 1e-12);
}

TEST(TriangleTree, RefusesACornerThatIsNotThere) {
  std::vector<Vec3> points(3, Vec3::Zero());
  std::vector<Triangle> triangles = {{0, 1, 7}};
  try {
    TriangleTree tree(points, triangles);
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("names point 7, but there are 3"));
  }
}

}  // namespace
}  // namespace deforma
