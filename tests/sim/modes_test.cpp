#include "sim/modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "statics_fixtures.hpp"

namespace deforma {
namespace {

class ModesOf : public testing::TestWithParam<Gradient> {};

INSTANTIATE_TEST_SUITE_P(Both, ModesOf, testing::Values(Gradient::linear, Gradient::quadratic), name_of);

Eigen::VectorXd free_masses(const Solver& solver) {
  const State& state = solver.state();
  std::vector<Vec3> mass;
  for (double m : state.particles.mass) mass.push_back(Vec3::Constant(m));
  return free_entries(mass, state.fixed);
}

void expect_orthonormal(const std::vector<Mode>& modes, const Solver& solver) {
  for (std::size_t a = 0; a < modes.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      double product = 0.0;
      for (std::size_t i = 0; i < modes[a].shape.size(); ++i)
        product += solver.state().particles.mass[i] * modes[a].shape[i].dot(modes[b].shape[i]);
      EXPECT_NEAR(product, a == b ? 1.0 : 0.0, 1e-9) << a << " and " << b;
    }
}

// Against a dense eigenvalue problem made without the solver.
void expect_modes_of_the_dense_problem(const Specimen& specimen, Solver& solver, int count) {
  const auto& fixed = solver.state().fixed;
  const Eigen::MatrixXd stiffness = dense_stiffness(specimen, solver.state().particles.displacement, fixed);
  const Eigen::VectorXd mass = free_masses(solver);
  Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(0.5 * (stiffness + stiffness.transpose()),
                                                                  Eigen::MatrixXd(mass.asDiagonal()));
  const std::vector<Vec3> before = solver.state().particles.displacement;
  const std::vector<Mode> modes = natural_modes(solver, count);
  EXPECT_EQ(solver.state().particles.displacement, before);
  ASSERT_EQ(modes.size(), static_cast<std::size_t>(count));
  expect_orthonormal(modes, solver);
  for (int k = 0; k < count; ++k) {
    const Mode& mode = modes[static_cast<std::size_t>(k)];
    const double square = dense.eigenvalues()[k];
    const double frequency = std::copysign(std::sqrt(std::abs(square)), square) / (2.0 * std::numbers::pi);
    EXPECT_NEAR(mode.frequency, frequency, 1e-4 * std::abs(frequency)) << k;
    const Eigen::VectorXd shape = free_entries(mode.shape, fixed);
    // A shape's error is about the square root of the frequency's.
    const double rayleigh = shape.dot(stiffness * shape) / shape.dot(mass.cwiseProduct(shape));
    EXPECT_NEAR(rayleigh, square, 2e-4 * std::abs(square)) << k;
    for (std::size_t i = 0; i < fixed.size(); ++i)
      if (fixed[i]) {
        EXPECT_EQ(mode.shape[i], Vec3(0, 0, 0));
      }
  }
}

TEST_P(ModesOf, AClampedBarAreThoseOfTheDenseProblem) {
  for (double jitter : {0.0, 0.2}) {
    Specimen bar(GetParam(), Vec3(1.0, 0.3, 0.3), 10, 3, 3, 1.0, jitter);
    bar.pin_below(0.12);
    Solver solver = bar.solver();
    expect_modes_of_the_dense_problem(bar, solver, 8);
    expect_modes_of_the_dense_problem(bar, solver, 60);  // more than a block holds
  }
}

TEST_P(ModesOf, ADeformedBodyAreThoseOfTheDenseProblemThere) {
  Specimen bar(GetParam(), Vec3(1.0, 0.3, 0.3), 10, 3, 3, 1.0);
  bar.pin_below(0.12);
  Solver solver = bar.solver();
  std::vector<Vec3> stretched;
  for (const Vec3& X : bar.state.particles.rest)
    stretched.push_back(std::max(0.0, X.x() - 0.1) * Vec3(0.2, 0.1, 0));
  solver.place(stretched);
  expect_modes_of_the_dense_problem(bar, solver, 8);
}

TEST_P(ModesOf, AFreeBodyBeginWithSixRigidOnes) {
  for (double jitter : {0.0, 0.2}) {
    Solver solver = Specimen(GetParam(), Vec3(1.0, 0.4, 0.3), 10, 4, 3, 1.0, jitter).solver();
    const std::vector<Mode> modes = natural_modes(solver, 10);
    expect_orthonormal(modes, solver);
    EXPECT_GT(modes[6].frequency, 100.0);
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_LT(std::abs(modes[k].frequency), 1e-3 * modes[6].frequency) << k;
    for (std::size_t k = 1; k < 10; ++k) EXPECT_GE(modes[k].frequency, modes[k - 1].frequency);
  }
}

TEST_P(ModesOf, AFreeBarBendAndTwistAsFiniteElementsDo) {
  // 182.31 Hz and 285.25 Hz by converged finite elements (27-node bricks).
  Solver solver = Specimen(GetParam(), Vec3(1.0, 0.2, 0.2), 30, 6, 6, 1.0).solver();
  const std::vector<Mode> modes = natural_modes(solver, 9);
  EXPECT_LT(std::abs(modes[5].frequency), 1.0);
  EXPECT_NEAR(modes[6].frequency / 182.31, 1.0, 0.05);
  EXPECT_NEAR(modes[7].frequency / modes[6].frequency, 1.0, 1e-4);  // the two planes
  EXPECT_NEAR(modes[8].frequency / 285.25, 1.0, 0.08);
}

TEST_P(ModesOf, ARopeAreThoseOfAnOrgan) {
  // f_k = k sqrt(E/rho) / 2L along a free rope; one motion without stiffness before them.
  Solver solver = Specimen(GetParam(), Vec3(1.0, 0.0125, 0.0125), 80, 1, 1, 1.0).solver();
  const std::vector<Mode> modes = natural_modes(solver, 3);
  EXPECT_LT(std::abs(modes[0].frequency), 0.5);
  for (std::size_t k = 1; k < 3; ++k)
    EXPECT_NEAR(modes[k].frequency / (500.0 * static_cast<double>(k)), 1.0, 0.03);
}

TEST_P(ModesOf, ASheetLieInItsPlane) {
  Solver solver = Specimen(GetParam(), Vec3(1.0, 0.05, 0.3), 20, 1, 6, 1.0).solver();
  const std::vector<Mode> modes = natural_modes(solver, 6);
  for (const Mode& mode : modes)
    for (const Vec3& u : mode.shape) EXPECT_LT(std::abs(u.y()), 1e-9);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(modes[k].frequency), 1e-3 * modes[3].frequency);
  // Bending in the plane: Timoshenko's beam, L/H = 3.33, is 0.8 of Euler's (4.7300^2 / 2 pi) sqrt(E I / rho A L^4).
  EXPECT_NEAR(modes[3].frequency / (22.3733 / (2.0 * std::numbers::pi) * 1e3 * 0.3 / std::sqrt(12.0)), 0.8,
              0.1);
}

TEST_P(ModesOf, ACompressedColumnShowThatItBuckles) {
  auto first = [&](double strain) {
    Specimen column(GetParam(), Vec3(1.0, 0.1, 0.1), 30, 3, 3, 1.0, 0.0, 1e6, 0.0);
    column.pin_below(0.04);
    column.add("pin",
               {{"region", Region{.min = Vec3(0.96, -1, -1)}}, {"move", Curve<Vec3>(Vec3(strain, 0, 0))}});
    Solver solver = column.solver();
    std::vector<Vec3> place;
    for (const Vec3& X : column.state.particles.rest) place.push_back(Vec3(strain * X.x(), 0, 0));
    solver.place(place);
    return natural_modes(solver, 1)[0].frequency;
  };
  // Euler's critical strain of a column clamped at both ends is 4 pi^2 I / A L^2 = 0.033.
  const double slack = first(0.0), tight = first(0.06);
  EXPECT_GT(slack, 50.0);
  EXPECT_GT(tight, 1.2 * slack);
  EXPECT_GT(first(-0.02), 0.0);
  EXPECT_LT(first(-0.08), 0.0);
}

TEST_P(ModesOf, TheSimulationSwingAtTheirFrequency) {
  Specimen bar(GetParam(), Vec3(1.0, 0.3, 0.3), 10, 3, 3, 1.0);
  bar.pin_below(0.12);
  Solver solver = bar.solver();
  const Mode mode = natural_modes(solver, 1, {.tolerance = 1e-6})[0];
  std::vector<Vec3> start;
  for (const Vec3& u : mode.shape) start.push_back(1e-6 * u);
  solver.place(start);
  auto amplitude = [&] {
    double product = 0.0;
    for (std::size_t i = 0; i < start.size(); ++i)
      product += 1e6 * solver.state().particles.mass[i] *
                 mode.shape[i].dot(solver.state().particles.displacement[i]);
    return product;
  };
  EXPECT_NEAR(amplitude(), 1.0, 1e-9);
  solver.advance(2.25 / mode.frequency);  // where it crosses zero
  EXPECT_LT(std::abs(amplitude()), 0.05);
  solver.advance(0.75 / mode.frequency);
  EXPECT_NEAR(amplitude(), 1.0, 5e-3);
}

TEST(Modes, RefuseWhatIsOutOfRange) {
  Specimen cube(Gradient::linear, Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  cube.pin_below(0.1);
  Solver solver = cube.solver();
  const char* range = "the number of modes must be in [1, 54], the free degrees of freedom, found ";
  EXPECT_THAT(refusal([&] { natural_modes(solver, 0); }), testing::HasSubstr(std::string(range) + "0"));
  EXPECT_THAT(refusal([&] { natural_modes(solver, 55); }), testing::HasSubstr(std::string(range) + "55"));
  EXPECT_EQ(natural_modes(solver, 54).size(), 54u);
  EXPECT_THAT(refusal([&] { natural_modes(solver, 1, {.tolerance = 1.0}); }),
              testing::HasSubstr("the tolerance of natural modes must be in (0, 1), found 1"));
  EXPECT_THAT(refusal([&] { natural_modes(solver, 1, {.most_iterations = 0}); }),
              testing::HasSubstr("the iterations to natural modes must be at least 1, found 0"));
}

TEST(Modes, OfWhatCannotMoveThereAreNone) {
  Specimen cube(Gradient::linear, Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  cube.pin_below(1.0);
  Solver solver = cube.solver();
  EXPECT_THAT(refusal([&] { natural_modes(solver, 1); }), testing::HasSubstr("must be in [1, 0]"));
}

TEST(Modes, OfALoneParticleAreItsThreeMotions) {
  Solver solver = Specimen(Gradient::linear, Vec3::Constant(0.1), 1, 1, 1, 1000.0).solver();
  const std::vector<Mode> modes = natural_modes(solver, 3);
  expect_orthonormal(modes, solver);
  for (const Mode& mode : modes) EXPECT_EQ(mode.frequency, 0.0);
}

TEST(Modes, SayWhenTheyWereNotFound) {
  Solver solver = Specimen(Gradient::quadratic, Vec3(1.0, 0.2, 0.2), 15, 3, 3, 1.0).solver();
  EXPECT_THAT(refusal([&] { natural_modes(solver, 12, {.tolerance = 1e-8, .most_iterations = 1}); }),
              testing::HasSubstr("the 12 lowest natural modes were not found in 1 iterations: the worst"));
}

}  // namespace
}  // namespace deforma
