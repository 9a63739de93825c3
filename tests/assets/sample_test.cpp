#include "assets/sample.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "assets/shapes.hpp"
#include "assets/solid.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;
using testing::Property;

Sampling by_count(const Mesh& mesh, std::size_t particles, Arrangement arrangement = Arrangement::lattice) {
  return sample_interior(mesh, {particles, 0.0, arrangement});
}

Sampling by_spacing(const Mesh& mesh, double spacing, Arrangement arrangement = Arrangement::lattice) {
  return sample_interior(mesh, {0, spacing, arrangement});
}

double least_distance(const std::vector<Vector3d>& points) {
  double least = 1e300;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, (points[i] - points[j]).norm());
  return least;
}

void expect_sound(const Mesh& mesh, const Sampling& sampling) {
  Solid solid(mesh);
  for (const Vector3d& p : sampling.points) {
    EXPECT_TRUE(solid.contains(p)) << p.transpose();
    EXPECT_GT(solid.distance(p, 1.0), 1e-4 * sampling.spacing) << p.transpose();
  }
  EXPECT_EQ(sampling.cells.size(), sampling.points.size());
  double volume = sampling.volume();
  EXPECT_NEAR(volume, solid.volume(), 1e-9 * volume);
  EXPECT_NEAR(std::pow(sampling.spacing, 3) * static_cast<double>(sampling.points.size()), volume,
              1e-9 * volume);
}

TEST(SampleByCount, GivesExactlySoManyInTheShippedShapes) {
  for (const auto& [mesh, count] : {std::pair{make_octahedron(0.5, 8), 299u},
                                    {make_ellipsoid({0.5, 0.4, 0.3}, 12), 568u},
                                    {make_cylinder(0.3, 1.2, 30, 18), 305u},
                                    {make_torus(1, 0.3, 48, 24), 1000u}}) {
    Sampling sampling = by_count(mesh, count);
    EXPECT_EQ(sampling.points.size(), count);
    EXPECT_GT(least_distance(sampling.points), 0.9 * sampling.spacing);
    expect_sound(mesh, sampling);
  }
}

TEST(SampleByCount, GivesExactlySoManyForEverySmallNumber) {
  Mesh sphere = make_sphere(1, 8), box = make_box({2, 1, 1}, 6);
  for (std::size_t count = 1; count <= 20; ++count)
    for (const Mesh& mesh : {sphere, box}) {
      Sampling sampling = by_count(mesh, count);
      EXPECT_EQ(sampling.points.size(), count);
      expect_sound(mesh, sampling);
    }
}

TEST(SampleByCount, GivesExactlySoManyInEveryArrangement) {
  Mesh mesh = make_ellipsoid({0.5, 0.4, 0.3}, 12);
  for (Arrangement arrangement : {Arrangement::lattice, Arrangement::body_centered, Arrangement::blue_noise})
    for (std::size_t count : {1u, 2u, 5u, 77u, 1234u}) {
      Sampling sampling = by_count(mesh, count, arrangement);
      EXPECT_EQ(sampling.points.size(), count);
      expect_sound(mesh, sampling);
    }
}

TEST(SampleByCount, ABoxThatFitsIsItsCellCenters) {
  for (const Sampling& sampling :
       {by_count(make_box({5, 1, 1}, 10), 320), by_spacing(make_box({5, 1, 1}, 10), 0.25)}) {
    ASSERT_EQ(sampling.points.size(), 320u);
    EXPECT_NEAR(sampling.spacing, 0.25, 1e-12);
    std::size_t at = 0;
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) {
          Vector3d center(-2.375 + 0.25 * i, -0.375 + 0.25 * j, -0.375 + 0.25 * k);
          EXPECT_NEAR((sampling.points[at++] - center).norm(), 0.0, 1e-12);
        }
  }
}

TEST(SampleByCount, SymmetricBodiesStayBalanced) {
  for (std::size_t count : {1u, 2u, 4u, 7u, 8u}) {
    Sampling sampling = by_count(make_sphere(1, 12), count);
    Vector3d sum = std::accumulate(sampling.points.begin(), sampling.points.end(), Vector3d(0, 0, 0));
    EXPECT_LT(sum.norm(), 1e-9) << count;
  }
}

TEST(SampleByCount, AThinPlateIsOneEvenLayer) {
  Mesh plate = make_box({1, 1, 1e-3}, 20);
  Sampling sampling = by_count(plate, 225);
  EXPECT_EQ(sampling.points.size(), 225u);
  EXPECT_GT(least_distance(sampling.points), 0.06);
  expect_sound(plate, sampling);
}

TEST(Sample, IsTheSameEveryTimeOnAnyNumberOfThreads) {
  Mesh mesh = make_torus(1, 0.3, 48, 24);
  for (Arrangement arrangement :
       {Arrangement::lattice, Arrangement::body_centered, Arrangement::blue_noise}) {
    Sampling many = by_count(mesh, 400, arrangement);
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(by_count(mesh, 400, arrangement).points, many.points);
  }
}

TEST(Sample, InsideOutIsSampledAsItsTwin) {
  Mesh mesh = make_ellipsoid({0.5, 0.4, 0.3}, 8);
  for (Arrangement arrangement : {Arrangement::lattice, Arrangement::body_centered}) {
    Sampling right = by_count(mesh, 500, arrangement), wrong = by_count(flipped(mesh), 500, arrangement);
    EXPECT_EQ(right.points, wrong.points);
    EXPECT_EQ(right.cells.size(), wrong.cells.size());
    EXPECT_TRUE(wrong.warnings.empty());
  }
}

TEST(Sample, OpenMeshesWorkWithAWarning) {
  Mesh open = make_sphere(1, 12);
  open.triangles.erase(open.triangles.begin() + 100, open.triangles.begin() + 140);
  Sampling sampling = by_count(open, 500);
  EXPECT_EQ(sampling.points.size(), 500u);
  EXPECT_THAT(sampling.warnings, Contains(HasSubstr("boundary edges")));
  double volume = sampling.volume();
  EXPECT_NEAR(volume / inspect(make_sphere(1, 12)).volume, 1.0, 0.02);
  for (const Vector3d& p : sampling.points) EXPECT_LT(p.norm(), 1.0);
}

TEST(Sample, OverlappingPartsShareOneLattice) {
  Mesh two = merged(make_sphere(1, 12), moved(make_sphere(1, 12), {1, 0, 0}));
  Sampling sampling = by_count(two, 1000);
  EXPECT_EQ(sampling.points.size(), 1000u);
  EXPECT_GT(least_distance(sampling.points), 0.9 * sampling.spacing);
  double ball = inspect(make_sphere(1, 12)).volume, lens = M_PI * 5.0 / 12.0;
  double volume = sampling.volume();
  EXPECT_NEAR(volume, 2.0 * ball - lens, 0.02 * volume);
}

TEST(SampleBlueNoise, IsEvenIrregularAndOffTheSurface) {
  Mesh mesh = make_sphere(1, 16);
  Sampling sampling = by_count(mesh, 800, Arrangement::blue_noise);
  Solid solid(mesh);
  EXPECT_GT(least_distance(sampling.points), 0.65 * sampling.spacing);
  for (const Vector3d& p : sampling.points) EXPECT_GT(solid.distance(p, 1.0), 0.25 * sampling.spacing);
}

TEST(SampleBodyCentered, NeighborsAreFartherThanOnACubicLattice) {
  Sampling sampling = by_spacing(make_box({4, 4, 4}, 4), 0.4, Arrangement::body_centered);
  double cell = 0.4 * std::cbrt(2.0);
  EXPECT_NEAR(least_distance(sampling.points), 0.5 * std::sqrt(3.0) * cell, 1e-9);
}

void expect_refused(const Mesh& mesh, const SamplingSettings& settings, const std::string& message) {
  EXPECT_THAT([&] { sample_interior(mesh, settings); },
              testing::Throws<std::runtime_error>(Property(&std::exception::what, HasSubstr(message))));
}

TEST(SampleRefuses, MeshesWithoutVolume) {
  Mesh triangle{{{0, 0, 0}, {1, 0, 0.1}, {0, 1, 0.3}}, {{0, 1, 2}}};
  Mesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  Mesh folded{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  Mesh both_sides = square;
  both_sides.triangles.push_back({2, 1, 0});
  both_sides.triangles.push_back({3, 2, 0});
  transform(both_sides, Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix(), {1, 1, 1},
            {0, 0, 0});
  for (const Mesh& mesh : {triangle, square, folded, both_sides, Mesh{}})
    for (Arrangement arrangement : {Arrangement::lattice, Arrangement::blue_noise})
      expect_refused(mesh, {100, 0.0, arrangement}, "encloses no volume");
}

TEST(SampleRefuses, AShellThinnerThanTheSpacing) {
  Mesh shell = merged(make_sphere(1, 24), flipped(make_sphere(0.98, 24)));
  expect_refused(shell, {0, 1.0}, "use at most 0.");
  expect_refused(make_sphere(1, 8), {0, 3.0}, "expected at least 4: use at most");
  EXPECT_EQ(by_count(shell, 1000).points.size(), 1000u);
}

TEST(SampleRefuses, MoreThanTheMemoryHolds) {
  expect_refused(make_sphere(1, 4), {1'000'000'000'000, 0.0},
                 "1e+12 particles need about 9.537e+05 GiB of memory");
  expect_refused(make_sphere(1, 4), {1'000'000'000, 0.0, Arrangement::lattice, 1e6},
                 "need about 9.313e+05 GiB");
  expect_refused(make_sphere(1, 4), {0, 1e-6}, "spacing: 1e-06 m: ");
}

TEST(SampleRefuses, SettingsThatMakeNoSense) {
  Mesh mesh = make_sphere(1, 4);
  auto refuses = [&](const SamplingSettings& settings, const std::string& message) {
    EXPECT_THAT([&] { sample_interior(mesh, settings); },
                testing::Throws<std::invalid_argument>(Property(&std::exception::what, HasSubstr(message))));
  };
  refuses({0, 0.0}, "expected one of them above 0, found 0 for both");
  refuses({0, -0.1}, "spacing: expected above 0 m, found -0.1");
  refuses({0, std::nan("")}, "spacing: expected above 0 m, found nan");
  mesh.points[3].x() = std::nan("");
  refuses({10, 0.0}, "point 3 is not finite");
}

}  // namespace
}  // namespace deforma
