#include "assets/cells.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "assets/lattice.hpp"
#include "assets/sample.hpp"
#include "assets/shapes.hpp"

namespace deforma {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(ParticleCells, OfALatticeInABoxAreItsCubes) {
  const Solid solid(make_box({1.0, 0.6, 0.4}, 2));
  const std::vector<Vector3d> points = lattice_by_spacing(solid, CellKind::cubic, 0.1);
  ASSERT_EQ(points.size(), 240u);
  for (bool lattice : {true, false})
    for (const CellMoments& cell : particle_cells(solid, points, 0.1, lattice)) {
      EXPECT_NEAR(cell.volume, 1e-3, 1e-12);
      EXPECT_LT(cell.first.norm(), 1e-13);
      EXPECT_LT((cell.second - 1e-5 / 12.0 * Matrix3d::Identity()).norm(), 1e-14);
    }
}

TEST(ParticleCells, ShareOutVolumeAndItsMomentsWhateverThePoints) {
  SamplingSettings settings{500, 0.0, Arrangement::blue_noise};
  for (double jitter : {0.0, 0.3}) {
    settings.jitter = jitter;
    const Vector3d size(1.0, 0.5, 0.5), middle(0.3, 0.2, 0.1);
    Mesh box = make_box(size, 2);
    transform(box, Matrix3d::Identity(), Vector3d::Ones(), middle);
    const Sampling sampling = sample_interior(box, settings);
    double volume = 0.0;
    Vector3d first = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();
    for (std::size_t i = 0; i < sampling.points.size(); ++i) {
      const CellMoments& cell = sampling.cells[i];
      const Vector3d& X = sampling.points[i];
      volume += cell.volume;
      first += cell.volume * X + cell.first;
      second += cell.volume * X * X.transpose() + cell.first * X.transpose() + X * cell.first.transpose() +
                cell.second;
    }
    // The blocks overhang the box: what is counted of it is off by a part of a cube.
    EXPECT_NEAR(volume, size.prod(), 1e-12);
    EXPECT_LT((first / volume - middle).norm(), 2e-3);
    second = second / volume - middle * middle.transpose();
    for (int a = 0; a < 3; ++a)
      EXPECT_NEAR(second(a, a), size[a] * size[a] / 12.0, 0.02 * size[a] * size[a] / 12.0);
  }
}

TEST(ParticleCells, ReachToTheSurfaceOfABall) {
  const Sampling sampling = sample_interior(make_ellipsoid({1, 1, 1}, 20), {600, 0.0});
  double smallest = 1e9, largest = 0.0;
  for (const CellMoments& cell : sampling.cells) {
    smallest = std::min(smallest, cell.volume);
    largest = std::max(largest, cell.volume);
  }
  const double share = sampling.volume() / 600.0;
  EXPECT_GT(smallest, 0.3 * share);
  EXPECT_LT(largest, 2.0 * share);
  double trace = 0.0;
  for (std::size_t i = 0; i < sampling.points.size(); ++i)
    trace += sampling.cells[i].volume * sampling.points[i].squaredNorm() +
             2.0 * sampling.cells[i].first.dot(sampling.points[i]) + sampling.cells[i].second.trace();
  EXPECT_NEAR(trace / sampling.volume(), 0.6, 0.01);
}

TEST(ParticleCells, OfAPlateMuchThinnerThanItsLatticeAreItsTiles) {
  const double thickness = 1e-3;
  SamplingSettings settings{0, 0.1};
  settings.held = {{.max = Vector3d(-0.5 + 1e-9, 9, 9)}};
  const Sampling sampling = sample_interior(make_box({1.0, 1.0, thickness}, 2), settings);
  EXPECT_EQ(sampling.on_surface, 10u);
  settings.held.clear();
  for (const CellMoments& cell : sample_interior(make_box({1.0, 1.0, thickness}, 2), settings).cells) {
    const double volume = 0.01 * thickness;
    EXPECT_NEAR(cell.volume, volume, 1e-9 * volume);
    EXPECT_NEAR(cell.second(0, 0), volume * 0.01 / 12.0, 1e-9 * volume * 0.01);
    EXPECT_NEAR(cell.second(1, 1), volume * 0.01 / 12.0, 1e-9 * volume * 0.01);
  }
}

// A diagonal rod: no two of its first points are neighbours in the lattice.
TEST(ParticleCells, OfALatticeWhoseFirstPointsLieOnADiagonal) {
  Mesh rod = make_box({4.0, 0.12, 0.12}, 4), ball = make_ellipsoid({0.75, 0.75, 0.75}, 16);
  transform(rod, Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitZ()).toRotationMatrix(),
            Vector3d::Ones(), Vector3d::Zero());
  const auto shift = static_cast<std::uint32_t>(rod.points.size());
  rod.points.insert(rod.points.end(), ball.points.begin(), ball.points.end());
  for (auto t : ball.triangles) {
    for (auto& corner : t) corner += shift;
    rod.triangles.push_back(t);
  }
  const Sampling sampling = sample_interior(rod, {0, 0.1});
  ASSERT_GT((sampling.points[1] - sampling.points[0]).norm(), 0.14);
  double largest = 0.0;
  for (const CellMoments& cell : sampling.cells) largest = std::max(largest, cell.volume);
  EXPECT_LT(largest, 2e-3);
  for (std::size_t i = 0; i < sampling.points.size(); ++i)
    if (sampling.points[i].norm() < 0.4) {
      EXPECT_NEAR(sampling.cells[i].volume, 1e-3, 1e-5);
    }
}

TEST(SurfacePoints, CoverAHeldFaceAsTheParticlesBelowIt) {
  SamplingSettings settings{0, 0.1};
  settings.held = {{.max = Vector3d(-0.5 + 1e-9, 9, 9)}};
  const Sampling sampling = sample_interior(make_box({1.0, 0.4, 0.4}, 2), settings);
  EXPECT_EQ(sampling.on_surface, 16u);
  ASSERT_EQ(sampling.points.size(), 176u);
  for (std::size_t i = 160; i < 176; ++i) {
    EXPECT_DOUBLE_EQ(sampling.points[i].x(), -0.5);
    EXPECT_NEAR(std::remainder(sampling.points[i].y() - 0.05, 0.1), 0.0, 1e-12);
    EXPECT_NEAR(std::remainder(sampling.points[i].z() - 0.05, 0.1), 0.0, 1e-12);
  }
  EXPECT_NEAR(sampling.volume(), 0.16, 1e-12);
}

TEST(SurfacePoints, AreNotNeededWhereParticlesAreHeldThemselves) {
  SamplingSettings settings{0, 0.1};
  settings.held = {{.max = Vector3d(-0.35, 9, 9)}};  // the first layer, and nothing near another
  const Sampling sampling = sample_interior(make_box({1.0, 0.4, 0.4}, 2), settings);
  for (std::size_t i = sampling.points.size() - sampling.on_surface; i < sampling.points.size(); ++i)
    EXPECT_LE(sampling.points[i].x(), -0.35);
}

TEST(Jitter, MovesPointsByNoMoreThanAskedAndLeavesALayerFlat) {
  SamplingSettings settings{0, 0.1};
  const Sampling still = sample_interior(make_box({1.0, 0.5, 0.1}, 2), settings);
  settings.jitter = 0.2;
  const Sampling moved = sample_interior(make_box({1.0, 0.5, 0.1}, 2), settings);
  ASSERT_EQ(still.points.size(), moved.points.size());
  double most = 0.0;
  for (std::size_t i = 0; i < still.points.size(); ++i) {
    const Vector3d step = (moved.points[i] - still.points[i]).cwiseAbs();
    EXPECT_LE(step.maxCoeff(), 0.02 + 1e-12);
    EXPECT_EQ(step.z(), 0.0);
    most = std::max(most, step.maxCoeff());
  }
  EXPECT_GT(most, 0.019);
}

}  // namespace
}  // namespace deforma
