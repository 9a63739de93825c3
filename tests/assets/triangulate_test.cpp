#include "assets/triangulate.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;

struct Areas {
  double total = 0.0;                  ///< of all triangles, whichever way they face
  Vector3d vector = Vector3d::Zero();  ///< sum of their area vectors
};

Areas areas_of(const std::vector<Vector3d>& polygon) {
  Areas areas;
  auto triangles = triangulate(polygon);
  EXPECT_EQ(triangles.size(), polygon.size() - 2);
  for (auto [a, b, c] : triangles) {
    Vector3d area = 0.5 * (polygon[b] - polygon[a]).cross(polygon[c] - polygon[a]);
    areas.total += area.norm();
    areas.vector += area;
  }
  return areas;
}

TEST(Triangulate, CoversConcavePolygonsOnceInAnyPlane) {
  std::vector<Vector3d> corner{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  std::vector<Vector3d> star;
  for (int i = 0; i < 14; ++i) {
    double r = i % 2 == 0 ? 1.0 : 0.3;
    star.emplace_back(r * std::cos(i * M_PI / 7), r * std::sin(i * M_PI / 7), 0);
  }
  for (auto polygon : {corner, star}) {
    Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    double expected = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
      expected += 0.5 * polygon[i].cross(polygon[(i + 1) % polygon.size()]).z();
    for (Vector3d& p : polygon) p = turn * p;
    Areas areas = areas_of(polygon);
    EXPECT_NEAR(areas.total, expected, 1e-12);
    EXPECT_NEAR((areas.vector - expected * turn.col(2)).norm(), 0.0, 1e-12) << "same way round";
  }
}

TEST(Triangulate, CutsAQuadAlongItsShorterDiagonal) {
  std::vector<Vector3d> kite{{-2, 0, 0}, {0, -1, 0}, {2, 0, 0}, {0, 1, 0}};
  for (const auto& t : triangulate(kite))
    EXPECT_EQ(std::count(t.begin(), t.end(), 1) + std::count(t.begin(), t.end(), 3), 2);
}

TEST(Triangulate, EndsWithOutlinesThatCrossThemselvesOrHaveNoArea) {
  EXPECT_EQ(triangulate(std::vector<Vector3d>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);
  EXPECT_EQ(triangulate(std::vector<Vector3d>(5, Vector3d(1, 1, 1))).size(), 3u);
  EXPECT_EQ(triangulate(std::vector<Vector3d>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}).size(), 2u);
  EXPECT_TRUE(triangulate(std::vector<Vector3d>{{0, 0, 0}, {1, 1, 0}}).empty());
}

}  // namespace
}  // namespace deforma
