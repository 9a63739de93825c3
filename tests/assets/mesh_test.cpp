#include "assets/mesh.hpp"

#include <Eigen/Geometry>

#include "assets/shapes.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing::Property;

TEST(MeshFacts, OfABox) {
  MeshFacts facts = inspect(moved(make_box({1, 2, 3}, 4), {10, 0, 0}));
  EXPECT_EQ(facts.boundary_edges, 0u);
  EXPECT_EQ(facts.non_manifold_edges, 0u);
  EXPECT_EQ(facts.components, 1u);
  EXPECT_NEAR(facts.volume, 6.0, 1e-12);
  EXPECT_NEAR(facts.area, 22.0, 1e-12);
  EXPECT_NEAR((facts.min - Vector3d(9.5, -1, -1.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((facts.max - Vector3d(10.5, 1, 1.5)).norm(), 0.0, 1e-12);
}

TEST(MeshFacts, VolumeKeepsItsDigitsFarFromTheOrigin) {
  EXPECT_NEAR(inspect(moved(make_box({1, 1, 1}, 2), Vector3d::Constant(1e6))).volume, 1.0, 1e-8);
}

TEST(MeshFacts, CountsPiecesHolesAndFins) {
  Mesh three = merged(merged(make_sphere(1, 4), moved(make_sphere(1, 4), {3, 0, 0})),
                      moved(make_sphere(1, 4), {6, 0, 0}));
  EXPECT_EQ(inspect(three).components, 3u);

  Mesh open = make_sphere(1, 4);
  open.triangles.pop_back();
  EXPECT_EQ(inspect(open).boundary_edges, 3u);

  Mesh fin = make_octahedron(1, 1);
  fin.points.push_back({2, 2, 0});
  fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], 6});
  EXPECT_EQ(inspect(fin).non_manifold_edges, 1u);
  EXPECT_EQ(inspect(fin).boundary_edges, 2u);

  Mesh disagreeing = make_octahedron(1, 1);
  std::swap(disagreeing.triangles[0][1], disagreeing.triangles[0][2]);
  EXPECT_EQ(inspect(disagreeing).non_manifold_edges, 3u);
}

TEST(MeshFacts, InsideOutIsNegative) {
  EXPECT_NEAR(inspect(flipped(make_box({1, 1, 1}, 1))).volume, -1.0, 1e-14);
}

TEST(MeshFacts, OfNothingAreZero) {
  MeshFacts facts = inspect({});
  EXPECT_EQ(facts.components, 0u);
  EXPECT_EQ(facts.max, Vector3d::Zero());
}

TEST(MeshFacts, RefuseAMissingPoint) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}};
  EXPECT_THAT([&] { inspect(mesh); },
              testing::Throws<std::invalid_argument>(
                  Property(&std::exception::what, HasSubstr("triangle 0 names point 3, expected below 3"))));
}

TEST(MeshTransform, ScalesThenTurnsThenMoves) {
  Mesh mesh{{{1, 0, 0}}, {}};
  Matrix3d quarter = Eigen::AngleAxisd(0.5 * M_PI, Vector3d::UnitZ()).toRotationMatrix();
  transform(mesh, quarter, {2, 1, 1}, {0, 0, 5});
  EXPECT_NEAR((mesh.points[0] - Vector3d(0, 2, 5)).norm(), 0.0, 1e-15);
}

TEST(MeshTransform, AMirrorImageStaysRightWay) {
  for (Vector3d scale : {Vector3d(-1, 1, 1), Vector3d(-1, -1, 1), Vector3d(-2, -1, -1)}) {
    Mesh mesh = make_box({1, 1, 1}, 2);
    transform(mesh, Matrix3d::Identity(), scale, Vector3d::Zero());
    EXPECT_NEAR(inspect(mesh).volume, std::abs(scale.prod()), 1e-14) << scale.transpose();
  }
}

TEST(MeshTransform, RefusesToFlatten) {
  Mesh mesh = make_box({1, 1, 1}, 1);
  EXPECT_THAT(
      [&] {
        transform(mesh, Matrix3d::Identity(), {1, 0, 1}, Vector3d::Zero());
      },
      testing::Throws<std::invalid_argument>(Property(&std::exception::what, HasSubstr("[1, 0, 1]"))));
}

TEST(MeshSubdivide, SharesMiddlesAndKeepsTheShape) {
  Mesh mesh = make_box({1, 1, 1}, 1);
  Mesh finer = mesh;
  subdivide(finer, 2);
  EXPECT_EQ(finer.triangles.size(), 16 * mesh.triangles.size());
  EXPECT_EQ(finer.points.size(), 2 + finer.triangles.size() / 2);  // Euler, closed, genus 0
  EXPECT_TRUE(std::equal(mesh.points.begin(), mesh.points.end(), finer.points.begin()));
  MeshFacts facts = inspect(finer);
  EXPECT_EQ(facts.boundary_edges, 0u);
  EXPECT_NEAR(facts.volume, 1.0, 1e-14);
  EXPECT_NEAR(facts.area, 6.0, 1e-14);
}

TEST(MeshSubdivide, ZeroTimesChangesNothingAndLessIsRefused) {
  Mesh mesh = make_octahedron(1, 1);
  subdivide(mesh, 0);
  EXPECT_EQ(mesh.triangles.size(), 8u);
  EXPECT_THAT([&] { subdivide(mesh, -1); },
              testing::Throws<std::invalid_argument>(Property(&std::exception::what, HasSubstr("found -1"))));
}

}  // namespace
}  // namespace deforma
