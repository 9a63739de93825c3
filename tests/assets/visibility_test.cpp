#include <random>

#include "assets/sample.hpp"
#include "assets/shapes.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;

TEST(Visibility, IsCutByTheGapBetweenLegs) {
  ASSERT_EQ(inspect(make_legs(0.1)).boundary_edges, 0u);
  ASSERT_NEAR(inspect(make_legs(0.1)).volume, 6.1, 1e-12);
  Visibility visibility(make_legs(0.1));
  EXPECT_FALSE(visibility.sees({0.9, 0.5, 2}, {1.2, 0.5, 2}));
  EXPECT_FALSE(visibility.sees({0.1, 0.5, 2.9}, {2.0, 0.2, 2.5}));
  EXPECT_TRUE(visibility.sees({0.9, 0.5, 0.5}, {1.2, 0.5, 0.5}));
  EXPECT_TRUE(visibility.sees({0.9, 0.5, 0.1}, {0.9, 0.5, 2.9}));
}

TEST(Visibility, OfASurfaceVertexIgnoresItsOwnTriangles) {
  Mesh mesh = make_legs(0.1);
  Visibility visibility(mesh);
  for (const Vector3d& vertex : mesh.points) {
    Vector3d own_leg(vertex.x() < 1.05 ? 0.5 : 1.6, 0.5, std::min(vertex.z(), 2.5));
    Vector3d other_leg(vertex.x() < 1.05 ? 1.6 : 0.5, 0.5, 2.5);
    EXPECT_TRUE(visibility.sees(vertex, own_leg)) << vertex.transpose();
    if (vertex.z() > 2) {
      EXPECT_FALSE(visibility.sees(vertex, other_leg)) << vertex.transpose();
    }
  }
}

TEST(Visibility, EverythingSeesEverythingInAConvexBody) {
  Mesh sphere = make_sphere(1, 12);
  Visibility visibility(sphere);
  std::mt19937 random(5);
  auto point = [&random] {
    Vector3d p;
    do {
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(random()) / 2147483648.0 - 1.0;
    } while (p.norm() > 0.95);
    return p;
  };
  for (int i = 0; i < 2000; ++i) {
    Vector3d a = point(), b = point();
    EXPECT_TRUE(visibility.sees(a, b));
    EXPECT_TRUE(visibility.sees(sphere.points[static_cast<std::size_t>(i) % sphere.points.size()], b));
  }
}

TEST(Visibility, NoWayOutSlipsThroughEdgesOrCorners) {
  // From the middle exactly through the corners and edges of a symmetric mesh, and past them.
  for (const Mesh& mesh : {make_octahedron(1, 4), make_box({1, 1, 1}, 4), make_sphere(1, 6)}) {
    Visibility visibility(mesh);
    for (const auto& t : mesh.triangles)
      for (int i = 0; i < 3; ++i) {
        const Vector3d &p = mesh.points[t[i]], &q = mesh.points[t[(i + 1) % 3]];
        for (const Vector3d& target : {p, Vector3d(0.5 * (p + q)), Vector3d(0.3 * p + 0.7 * q)}) {
          EXPECT_FALSE(visibility.sees(Vector3d::Zero(), 2.0 * target));
          EXPECT_FALSE(visibility.sees(2.0 * target, Vector3d::Zero()));
        }
      }
  }
}

TEST(Visibility, IsMutual) {
  Visibility visibility(make_torus(1, 0.3, 32, 16));
  std::mt19937 random(9);
  auto point = [&random] {
    Vector3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = 1.4 * (static_cast<double>(random()) / 2147483648.0 - 1.0);
    return p;
  };
  for (int i = 0; i < 5000; ++i) {
    Vector3d a = point(), b = point();
    EXPECT_EQ(visibility.sees(a, b), visibility.sees(b, a));
  }
}

TEST(Visibility, APointSeesItself) {
  EXPECT_TRUE(Visibility(make_sphere(1, 4)).sees({0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}));
}

}  // namespace
}  // namespace deforma
