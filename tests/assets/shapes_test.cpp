#include "assets/shapes.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using testing::HasSubstr;
using testing::Property;

void expect_closed(const Mesh& mesh, const std::string& name, std::size_t genus = 0) {
  MeshFacts facts = inspect(mesh);
  EXPECT_EQ(facts.boundary_edges, 0u) << name;
  EXPECT_EQ(facts.non_manifold_edges, 0u) << name;
  EXPECT_EQ(facts.components, 1u) << name;
  EXPECT_GT(facts.volume, 0.0) << name;
  EXPECT_EQ(mesh.points.size() + 2 * genus, mesh.triangles.size() / 2 + 2) << name;  // Euler
  for (const auto& t : mesh.triangles) {
    Vector3d ab = mesh.points[t[1]] - mesh.points[t[0]], ac = mesh.points[t[2]] - mesh.points[t[0]];
    EXPECT_GT(ab.cross(ac).norm(), 1e-6 * facts.area / static_cast<double>(mesh.triangles.size())) << name;
  }
}

/// The longest edge over the shortest.
double unevenness(const Mesh& mesh) {
  double shortest = 1e300, longest = 0.0;
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      double length = (mesh.points[t[i]] - mesh.points[t[(i + 1) % 3]]).norm();
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
  return longest / shortest;
}

TEST(Shapes, AreClosedAndFaceOutwardsAtEveryResolution) {
  for (int n : {1, 2, 3, 8}) {
    std::string at = " at " + std::to_string(n);
    expect_closed(make_box({1, 2, 0.3}, n), "box" + at);
    expect_closed(make_sphere(0.7, n), "sphere" + at);
    expect_closed(make_ellipsoid({1, 2, 3}, n), "ellipsoid" + at);
    expect_closed(make_octahedron(0.5, n), "octahedron" + at);
    expect_closed(make_torus(1, 0.3, 2 + n, 4 + n), "torus" + at, 1);
    expect_closed(make_cylinder(0.5, 1, 2 + n, 1 + n), "cylinder" + at);
  }
}

TEST(Shapes, HaveTheirVolumes) {
  EXPECT_NEAR(inspect(make_box({1, 2, 3}, 5)).volume, 6.0, 1e-12);
  EXPECT_NEAR(inspect(make_octahedron(0.5, 7)).volume, 4.0 / 3.0 * 0.125, 1e-14);
  EXPECT_NEAR(inspect(make_sphere(1, 32)).volume / (4.0 / 3.0 * pi), 1.0, 2e-3);
  EXPECT_NEAR(inspect(make_ellipsoid({1, 2, 3}, 32)).volume / (8.0 * pi), 1.0, 2e-3);
  EXPECT_NEAR(inspect(make_torus(1, 0.3, 96, 48)).volume / (2.0 * pi * pi * 0.09), 1.0, 5e-3);
  double prism = 0.5 * 30 * std::sin(2.0 * pi / 30) * 0.25 * 1.2;
  EXPECT_NEAR(inspect(make_cylinder(0.5, 1.2, 30, 18)).volume, prism, 1e-12);
}

TEST(Shapes, FillTheirBounds) {
  MeshFacts sphere = inspect(make_sphere(2, 5)), octahedron = inspect(make_octahedron(2, 5));
  for (const MeshFacts& facts : {sphere, octahedron}) {
    EXPECT_NEAR((facts.max - Vector3d::Constant(2)).norm(), 0.0, 1e-14);
    EXPECT_NEAR((facts.min + Vector3d::Constant(2)).norm(), 0.0, 1e-14);
  }
}

TEST(Shapes, AreEvenlyTessellated) {
  EXPECT_LT(unevenness(make_sphere(1, 16)), 2.4);
  EXPECT_LT(unevenness(make_box({5, 1, 1}, 20)), 1.5);
  EXPECT_LT(unevenness(make_octahedron(1, 9)), 1.0 + 1e-9);
}

TEST(Cylinder, HasExactlyTheCountsOfItsRings) {
  for (auto [segments, rings] : {std::pair{30, 18}, {36, 15}, {27, 20}, {3, 2}, {7, 3}}) {
    Mesh mesh = make_cylinder(0.5, 1.0, segments, rings);
    EXPECT_EQ(mesh.points.size(), static_cast<std::size_t>(segments * rings));
    EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(2 * segments * rings - 4));
  }
  EXPECT_EQ(make_cylinder(0.5, 1.0, 30, 18).points.size(), 540u);
  EXPECT_EQ(make_cylinder(0.5, 1.0, 30, 18).triangles.size(), 1076u);
}

TEST(Cylinder, SharesItsRingsBetweenSideAndCaps) {
  auto rings_below_top = [](double height) {
    Mesh mesh = make_cylinder(0.5, height, 30, 18);
    return std::count_if(mesh.points.begin(), mesh.points.end(),
                         [&](const Vector3d& p) {
                           return p.z() < 0.5 * height - 1e-9 && p.z() > -0.5 * height + 1e-9;
                         }) /
           30;
  };
  EXPECT_GT(rings_below_top(4.0), rings_below_top(1.0));
  EXPECT_GT(rings_below_top(1.0), rings_below_top(0.2));
}

TEST(Shapes, RefuseWhatIsNoShape) {
  auto refuses = [](const auto& make, const std::string& message) {
    EXPECT_THAT(make,
                testing::Throws<std::invalid_argument>(Property(&std::exception::what, HasSubstr(message))));
  };
  refuses([] { make_box({1, 0, 1}, 2); }, "box: size: expected three lengths above 0 m, found [1, 0, 1]");
  refuses([] { make_box({1, 1, 1}, 0); }, "box: resolution: expected 1 or more, found 0");
  refuses([] { make_sphere(-1, 2); }, "sphere: radius: expected above 0 m, found -1");
  refuses([] { make_sphere(std::nan(""), 2); }, "sphere: radius");
  refuses([] { make_ellipsoid({1, 1, -1}, 2); }, "ellipsoid: radii");
  refuses([] { make_octahedron(1, 0); }, "octahedron: resolution");
  refuses([] { make_torus(1, 1, 8, 8); }, "torus: tube_radius: expected below the radius 1 m, found 1");
  refuses([] { make_torus(1, 0.2, 8, 2); }, "torus: rings: expected 3 or more, found 2");
  refuses([] { make_cylinder(1, 1, 2, 4); }, "cylinder: segments: expected 3 or more, found 2");
  refuses([] { make_cylinder(1, 1, 8, 1); }, "cylinder: rings: expected 2 or more, found 1");
}

}  // namespace
}  // namespace deforma
