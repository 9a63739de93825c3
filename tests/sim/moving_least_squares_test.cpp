#include "sim/moving_least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "fixtures.hpp"

namespace deforma {
namespace {

const Mat3 gradient =
    (Mat3() << 0.1, 0.7, -0.2, 0.0, -0.3, 0.4, 0.25, 0.0, 0.2).finished();  // unsymmetric on purpose

class EveryKernelFit : public testing::TestWithParam<int> {};

TEST_P(EveryKernelFit, ReproducesLinearFieldsToRounding) {
  NeighborhoodSettings settings{.kernel = static_cast<Kernel>(GetParam())};
  State state = lattice_box(Vec3(0.5, 0.6, 0.7), 5, 6, 7, 1000.0, 0.25, settings);
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.displacement[i] = gradient * state.particles.rest[i] + Vec3(1, 2, 3);
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  for (const Mat3& F : state.F) EXPECT_LT((F - Mat3::Identity() - gradient).norm(), 2e-13);
}

INSTANTIATE_TEST_SUITE_P(Kernels, EveryKernelFit, testing::Range(1, 6));

TEST(MovingLeastSquares, TheQuadraticFitReproducesQuadraticFields) {
  State state = lattice_box(Vec3(0.5, 0.6, 0.7), 5, 6, 7, 1000.0, 0.25, {.neighbors = 30, .support = 1.7},
                            Gradient::quadratic);
  EXPECT_EQ(state.fit.linear_fits, 0u);
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3& X = state.particles.rest[i];
    state.particles.displacement[i] =
        gradient * X + Vec3(X.x() * X.x(), X.x() * X.y() - X.z() * X.z(), X.y() * X.z());
  }
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3& X = state.particles.rest[i];
    Mat3 exact = Mat3::Identity() + gradient;
    exact += (Mat3() << 2 * X.x(), 0, 0, X.y(), X.x(), -2 * X.z(), 0, X.z(), X.y()).finished();
    EXPECT_LT((state.F[i] - exact).norm(), 1e-11);
  }
}

TEST(MovingLeastSquares, TheQuadraticFitOfThinBodiesLeavesOutWhatTheyCannotTell) {
  struct Case {
    Eigen::Vector3i count;
    bool across;  // u = yz and zx too, which a body of one layer does not see
    bool wide;
  };
  for (const Case& c :
       {Case{{6, 6, 2}, true, true}, Case{{6, 6, 1}, false, true}, Case{{12, 1, 1}, false, false}}) {
    const Vec3 size = 0.1 * c.count.cast<double>();
    State state = lattice_box(size, c.count.x(), c.count.y(), c.count.z(), 1000.0, 0.0,
                              {.neighbors = 30, .support = 1.7}, Gradient::quadratic);
    EXPECT_EQ(state.fit.linear_fits, 0u) << c.count.transpose();
    const double y = c.wide, yz = c.across;
    for (std::size_t i = 0; i < state.size(); ++i) {
      const Vec3 X = state.particles.rest[i] - state.particles.rest[0];
      state.particles.displacement[i] =
          Vec3(X.x() * X.x() + y * X.x() * X.y(), y * X.y() * X.y() + yz * X.y() * X.z(), yz * X.z() * X.x());
    }
    deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
    for (std::size_t i = 0; i < state.size(); ++i) {
      const Vec3 X = state.particles.rest[i] - state.particles.rest[0];
      Mat3 exact;
      exact << 2 * X.x() + y * X.y(), y * X.x(), 0,   //
          0, 2 * y * X.y() + yz * X.z(), yz * X.y(),  //
          yz * X.z(), 0, yz * X.x();
      EXPECT_LT((state.F[i] - state.fit.projector(i) - exact).norm(), 1e-11) << c.count.transpose();
    }
  }
}

TEST(MovingLeastSquares, TheQuadraticFitOfThinBodiesTurnsWithThem) {
  for (const Eigen::Vector3i& count : {Eigen::Vector3i(6, 6, 2), {6, 6, 1}, {12, 1, 1}}) {
    const Vec3 size = 0.1 * count.cast<double>();
    State level = lattice_particles(size, count.x(), count.y(), count.z(), 1000.0);
    State turned = level;
    const Mat3 R = Eigen::AngleAxisd(1.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (Vec3& X : turned.particles.rest) X = R * X + Vec3(3, 4, 5);
    for (Vec3& X : turned.surface.rest) X = R * X + Vec3(3, 4, 5);
    for (Cell& cell : turned.particles.cells) cell = {R * cell.first, R * cell.second * R.transpose()};
    for (State* state : {&level, &turned}) {
      prepare_state(*state, {.neighbors = 30, .support = 1.7}, {}, {}, Gradient::quadratic);
      EXPECT_EQ(state->fit.linear_fits, 0u) << count.transpose();
    }
    ASSERT_EQ(level.fit.there.size(), turned.fit.there.size());
    for (std::size_t l = 0; l < level.fit.there.size(); ++l)
      EXPECT_LT((gradient_vector(turned.fit.there[l]) - R * gradient_vector(level.fit.there[l])).norm(),
                1e-10);
    for (std::size_t i = 0; i < level.size(); ++i)
      EXPECT_NEAR(turned.fit.weight[i], level.fit.weight[i], 1e-10 * level.fit.weight[i]);
  }
}

TEST(MovingLeastSquares, AnAlmostFlatSheetIsLeftToTheLinearFit) {
  State state = lattice_particles(Vec3(0.6, 0.6, 0.1), 6, 6, 1, 1000.0);
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.rest[i].z() += 1e-5 * std::sin(3.0 * static_cast<double>(i));
  prepare_state(state, {.neighbors = 30, .support = 1.7}, {}, {}, Gradient::quadratic);
  EXPECT_EQ(state.fit.linear_fits, state.size());
  const Mat3 R = Eigen::AngleAxisd(1.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.displacement[i] = R * state.particles.rest[i] - state.particles.rest[i];
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  for (std::size_t i = 0; i < state.size(); ++i)
    EXPECT_LT((state.F[i].transpose() * state.F[i] - state.fit.projector(i)).norm(), 1e-12);
}

TEST(MovingLeastSquares, TheWeightsIntegrateQuadraticFieldsOverTheBody) {
  for (double jitter : {0.0, 0.1}) {
    const Vec3 size(1.2, 0.4, 0.5);
    State state =
        lattice_box(size, 12, 4, 5, 1000.0, jitter, {.neighbors = 30, .support = 1.7}, Gradient::quadratic);
    double plain = 0.0, weighted = 0.0, linear = 0.0, volume = 0.0, mixed = 0.0;
    for (std::size_t i = 0; i < state.size(); ++i) {
      const Vec3& X = state.particles.rest[i];
      plain += state.particles.volume[i] * std::pow(X.y() - 0.2, 2);
      weighted += state.fit.weight[i] * std::pow(X.y() - 0.2, 2);
      mixed += state.fit.weight[i] * X.x() * X.z();
      linear += state.fit.weight[i] * X.x();
      volume += state.fit.weight[i];
    }
    const double exact = size.prod() * 0.4 * 0.4 / 12.0;
    EXPECT_NEAR(weighted, exact, 1e-10 * exact) << jitter;
    EXPECT_NEAR(mixed, size.prod() * 0.6 * 0.25, 1e-10) << jitter;
    EXPECT_NEAR(linear, size.prod() * 0.6, 1e-10) << jitter;
    EXPECT_NEAR(volume, size.prod(), 1e-10) << jitter;
    EXPECT_LT(plain, 0.95 * exact) << jitter;
  }
}

TEST(MovingLeastSquares, TheWeightsOfTheLinearFitAreTheVolumes) {
  State state = lattice_box(Vec3::Constant(0.4), 4, 4, 4, 1000.0, 0.2);
  EXPECT_EQ(state.fit.weight, state.particles.volume);
}

TEST(MovingLeastSquares, SeesTheRankOfSheetsRopesAndLoneParticles) {
  State sheet = lattice_box(Vec3(0.6, 0.6, 0.1), 6, 6, 1, 1000.0);
  State rope = lattice_box(Vec3(1.2, 0.1, 0.1), 12, 1, 1, 1000.0);
  State one = lattice_box(Vec3(0.1, 0.1, 0.1), 1, 1, 1, 1000.0);
  EXPECT_EQ(sheet.fit.count_below(3), 36u);
  EXPECT_EQ(sheet.fit.count_below(2), 0u);
  EXPECT_EQ(rope.fit.count_below(2), 12u);
  EXPECT_EQ(rope.fit.count_below(1), 0u);
  EXPECT_EQ(one.fit.rank[0], 0);
  EXPECT_TRUE(one.F[0].isZero());
  EXPECT_NEAR((sheet.fit.projector(7) - Vec3(1, 1, 0).asDiagonal().toDenseMatrix()).norm(), 0.0, 1e-12);
}

TEST(MovingLeastSquares, ASheetTurnsWithItsRotation) {
  State sheet = lattice_box(Vec3(0.6, 0.6, 0.1), 6, 6, 1, 1000.0);
  Mat3 R = Eigen::AngleAxisd(1.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < sheet.size(); ++i)
    sheet.particles.displacement[i] = R * sheet.particles.rest[i] - sheet.particles.rest[i];
  deformation_gradients(sheet.links, sheet.fit, sheet.particles.displacement, sheet.F);
  for (std::size_t i = 0; i < sheet.size(); ++i)
    EXPECT_LT((sheet.F[i] - R * sheet.fit.projector(i)).norm(), 1e-13);
}

TEST(MovingLeastSquares, IsFreeOfScale) {
  State small = lattice_box(Vec3::Constant(0.6e-6), 6, 6, 6, 1000.0, 0.2);
  State large = lattice_box(Vec3::Constant(0.6e6), 6, 6, 6, 1000.0, 0.2);
  ASSERT_EQ(small.links.links.size(), large.links.links.size());
  for (std::size_t i = 0; i < small.size(); ++i)
    EXPECT_LT((small.fit.inverse[i] * 1e-24 - large.fit.inverse[i]).norm(),
              1e-6 * large.fit.inverse[i].norm());
}

TEST(MovingLeastSquares, RefusesArraysOfDifferentLength) {
  State state = lattice_box(Vec3::Ones(), 3, 3, 3, 1000.0);
  std::vector<Vec3> field(5);
  EXPECT_THROW(deformation_gradients(state.links, state.fit, field, state.F), std::invalid_argument);
}

}  // namespace
}  // namespace deforma
