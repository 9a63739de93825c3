#include "sim/equilibrium.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "statics_fixtures.hpp"

namespace deforma {
namespace {

using Values = std::vector<std::pair<std::string_view, SettingValue>>;

class EquilibriumOf : public testing::TestWithParam<Gradient> {};

INSTANTIATE_TEST_SUITE_P(Both, EquilibriumOf, testing::Values(Gradient::linear, Gradient::quadratic),
                         name_of);

double norm(std::span<const Vec3> field) {
  double sum = 0.0;
  for (const Vec3& v : field) sum += v.squaredNorm();
  return std::sqrt(sum);
}

double lowest(const Solver& solver) {
  double z = 0.0;
  for (const Vec3& u : solver.state().particles.displacement) z = std::min(z, u.z());
  return z;
}

// PL^2/EI = `load` on a bar of length 1 and height `height`.
Specimen cantilever(Gradient gradient, int nx, int n, double load, double poisson = 0.3,
                    double jitter = 0.0) {
  const double height = static_cast<double>(n) / nx, young = 1e6;
  Specimen bar(gradient, Vec3(1.0, height, height), nx, n, n, 1000.0, jitter, young, poisson);
  bar.pin_below(1.01 / nx);
  bar.load_end(1.0, Vec3(0, 0, -load * young * std::pow(height, 4) / 12.0));
  return bar;
}

TEST_P(EquilibriumOf, ASmallLoadIsTheSolutionOfTheDifferencedStiffness) {
  for (double jitter : {0.0, 0.2}) {
    Specimen bar(GetParam(), Vec3(0.6, 0.3, 0.3), 6, 3, 3, 1000.0, jitter);
    bar.pin_below(0.1);
    bar.add("gravity", {{"acceleration", Curve<Vec3>(Vec3(1e-4, 0, -1e-3))}});
    Solver solver = bar.solver();
    Equilibrium found = find_equilibrium(solver, {.tolerance = 1e-9});
    EXPECT_TRUE(found.converged);
    const auto& fixed = solver.state().fixed;
    std::vector<Vec3> rest(solver.state().size(), Vec3::Zero());
    Eigen::VectorXd load = free_entries(force_without_solver(bar, rest, fixed), fixed);
    Eigen::VectorXd expected = dense_stiffness(bar, rest, fixed).ldlt().solve(load);
    Eigen::VectorXd actual = free_entries(solver.state().particles.displacement, fixed);
    EXPECT_LT((actual - expected).norm(), 1e-5 * expected.norm());
  }
}

TEST_P(EquilibriumOf, AHangingBarStretchesByItsWeight) {
  const double young = 1e6, density = 1000.0, g = 9.81, length = 1.0;
  Specimen bar(GetParam(), Vec3(length, 0.2, 0.2), 30, 6, 6, density, 0.0, young, 0.0);
  bar.pin_below(1.01 / 30);
  bar.add("gravity", {{"acceleration", Curve<Vec3>(Vec3(1e-3 * g, 0, 0))}});
  Solver solver = bar.solver();
  EXPECT_TRUE(find_equilibrium(solver).converged);
  double stretch = 0.0;
  for (const Vec3& u : solver.state().particles.displacement) stretch = std::max(stretch, u.x());
  // Held is the first layer, half a spacing inside; where the clamp acts is within a spacing of it.
  const double free_length = length - 0.5 / 30;
  EXPECT_NEAR(stretch / (density * 1e-3 * g * free_length * free_length / (2.0 * young)), 1.0, 0.08);
}

TEST_P(EquilibriumOf, TheResidualIsAsSmallAsItSays) {
  Specimen bar = cantilever(GetParam(), 24, 4, 1.0, 0.3, 0.2);
  Solver solver = bar.solver();
  Equilibrium found = find_equilibrium(solver);
  EXPECT_TRUE(found.converged);
  EXPECT_GT(found.residual, 0.0);
  const auto& fixed = solver.state().fixed;
  const auto& place = solver.state().particles.displacement;
  Specimen loads = bar;
  std::erase_if(loads.requests, [](const EffectRequest& request) { return request.effect != "load"; });
  double load = norm(force_without_solver(loads, place, fixed));
  double residual = norm(force_without_solver(bar, place, fixed));
  EXPECT_LE(residual, 1e-6 * solver.applied_load());
  EXPECT_NEAR(residual / solver.applied_load(), found.residual, 1e-2 * found.residual + 1e-12);
  EXPECT_GE(solver.applied_load(), load);  // the clamp's forces are larger, by the lever
  EXPECT_LT(lowest(solver), -0.1);
}

TEST_P(EquilibriumOf, ASlenderBarFollowsTheElastica) {
  // v/L under a dead end load, nu = 0; Mattiasson, Int. J. Numer. Meth. Engng 17 (1981), table I.
  for (auto [load, deflection] : {std::pair{1.0, 0.30172}, {10.0, 0.81061}}) {
    Solver solver = cantilever(GetParam(), 80, 4, load, 0.0).solver();
    Equilibrium found = find_equilibrium(solver);
    EXPECT_TRUE(found.converged);
    EXPECT_LT(found.force_evaluations, 400);
    EXPECT_NEAR(-lowest(solver) / deflection, 1.0, 0.06) << load;
  }
}

TEST_P(EquilibriumOf, SlendernessCostsNoIterations) {
  for (int nx : {16, 160}) {
    Solver solver = cantilever(GetParam(), nx, 4, 1e-4).solver();
    Equilibrium found = find_equilibrium(solver);
    EXPECT_TRUE(found.converged);
    EXPECT_LT(found.force_evaluations, 150) << nx;
  }
}

TEST_P(EquilibriumOf, ASheetIsFoundInItsPlane) {
  Specimen sheet(GetParam(), Vec3(1.2, 0.1, 0.6), 12, 1, 6, 1000.0);
  sheet.pin_below(0.1);
  sheet.load_end(1.2, Vec3(0, 0, -1.0));
  Solver solver = sheet.solver();
  EXPECT_TRUE(find_equilibrium(solver, {.tolerance = 1e-9}).converged);
  const auto& fixed = solver.state().fixed;
  std::vector<Vec3> rest(solver.state().size(), Vec3::Zero());
  Eigen::VectorXd load = free_entries(force_without_solver(sheet, rest, fixed), fixed);
  // Across the plane nothing resists affine motion: there the differenced stiffness is singular.
  std::vector<Eigen::Index> within;
  for (Eigen::Index k = 0; k < load.size(); ++k)
    if (k % 3 != 1) within.push_back(k);
  Eigen::MatrixXd stiffness = dense_stiffness(sheet, rest, fixed)(within, within);
  Eigen::VectorXd expected = stiffness.ldlt().solve(Eigen::VectorXd(load(within)));
  Eigen::VectorXd actual = free_entries(solver.state().particles.displacement, fixed);
  EXPECT_LT((actual(within) - expected).norm(), 2e-3 * expected.norm());
  for (const Vec3& u : solver.state().particles.displacement) EXPECT_EQ(u.y(), 0.0);
}

TEST_P(EquilibriumOf, MovedAndTurnedPinsHold) {
  Specimen bar(GetParam(), Vec3(0.8, 0.3, 0.3), 8, 3, 3, 1000.0, 0.1);
  bar.pin_below(0.15);
  const Region right{.min = Vec3(0.65, -1, -1)};
  bar.add("pin", {{"region", right},
                  {"move", Curve<Vec3>(Vec3(0.05, 0, -0.1))},
                  {"rotation", Curve<Vec3>(Vec3(60, 0, 0))},
                  {"center", Curve<Vec3>(Vec3(0.7, 0.15, 0.15))}});
  Solver solver = bar.solver();
  Equilibrium found = find_equilibrium(solver, {.tolerance = 1e-8});
  EXPECT_TRUE(found.converged);
  const Particles& p = solver.state().particles;
  const Vec3 center(0.7, 0.15, 0.15);
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 3.0, Vec3::UnitX()).toRotationMatrix();
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_EQ(p.velocity[i], Vec3(0, 0, 0));
    if (p.rest[i].x() <= 0.15) {
      EXPECT_EQ(p.displacement[i], Vec3(0, 0, 0));
    }
    if (right.contains(p.rest[i])) {
      Vec3 place = center + turn * (p.rest[i] - center) + Vec3(0.05, 0, -0.1);
      EXPECT_LT((p.position(i) - place).norm(), 1e-14);
    }
  }
  EXPECT_LE(norm(force_without_solver(bar, p.displacement, solver.state().fixed)),
            1e-8 * solver.applied_load());
}

TEST_P(EquilibriumOf, ARunThatStartsThereStaysThere) {
  Solver solver = cantilever(GetParam(), 16, 4, 0.5).solver();
  EXPECT_TRUE(find_equilibrium(solver, {.tolerance = 1e-8}).converged);
  const std::vector<Vec3> before = solver.state().particles.displacement;
  const double sag = -lowest(solver);
  solver.advance(0.5);  // 16 periods
  double moved = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i)
    moved = std::max(moved, (solver.state().particles.displacement[i] - before[i]).norm());
  EXPECT_GT(sag, 0.1);
  EXPECT_LT(moved, 1e-5 * sag);
}

TEST_P(EquilibriumOf, AScrambledBodyWithNothingOnItFindsItsShape) {
  Specimen cube(GetParam(), Vec3::Constant(0.5), 5, 5, 5, 1000.0);
  scramble(cube.state, 0.01);
  Solver solver = cube.solver();
  Equilibrium found = find_equilibrium(solver);
  EXPECT_TRUE(found.converged);
  for (const Mat3& F : solver.state().F) EXPECT_LT((F.transpose() * F - Mat3::Identity()).norm(), 1e-4);
}

TEST_P(EquilibriumOf, ABodyAtRestIsLeftAlone) {
  Solver solver = Specimen(GetParam(), Vec3::Constant(0.5), 5, 5, 5, 1000.0, 0.2).solver();
  Equilibrium found = find_equilibrium(solver);
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.residual, 0.0);
  EXPECT_EQ(found.iterations, 0);
  for (const Vec3& u : solver.state().particles.displacement) EXPECT_EQ(u, Vec3(0, 0, 0));
}

TEST_P(EquilibriumOf, OfWhatIsHeldEntirelyItIsWhereItIs) {
  Specimen cube(GetParam(), Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  cube.pin_below(1.0);
  cube.add("gravity");
  Solver solver = cube.solver();
  Equilibrium found = find_equilibrium(solver);
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.residual, 0.0);
}

TEST_P(EquilibriumOf, ACompressedColumnIsFoundBuckled) {
  // Far beyond Euler's strain of 0.013, and a little to one side.
  Specimen column(GetParam(), Vec3(1.0, 0.1, 0.1), 30, 3, 3, 1000.0);
  column.pin_below(0.04);
  column.add("pin",
             {{"region", Region{.min = Vec3(0.96, -1, -1)}}, {"move", Curve<Vec3>(Vec3(-0.15, 0, 1e-3))}});
  Solver solver = column.solver();
  Equilibrium found = find_equilibrium(solver);
  EXPECT_TRUE(found.converged);
  double aside = 0.0, squeezed = 1.0;
  for (std::size_t i = 0; i < solver.state().size(); ++i) {
    const Vec3& u = solver.state().particles.displacement[i];
    aside = std::max(aside, std::hypot(u.y(), u.z()));
    squeezed = std::min(squeezed, solver.state().F[i].determinant());
  }
  // An inextensible bar shortened by s bulges by about 2 sqrt(s L) / pi.
  EXPECT_NEAR(aside, 2.0 * std::sqrt(0.15) / std::numbers::pi, 0.05);
  EXPECT_GT(squeezed, 0.5);
}

TEST_P(EquilibriumOf, AFreelyFallingBodyHasNone) {
  Specimen cube(GetParam(), Vec3::Constant(0.5), 5, 5, 5, 1000.0, 0.1);
  cube.add("gravity");
  Solver solver = cube.solver();
  Equilibrium found = find_equilibrium(solver);
  EXPECT_FALSE(found.converged);
  EXPECT_GT(found.residual, 0.5);
  for (const Vec3& u : solver.state().particles.displacement) EXPECT_TRUE(u.allFinite());
}

TEST_P(EquilibriumOf, FromAPlaceThatIsNoNumberNoneIsFound) {
  Specimen cube(GetParam(), Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  cube.state.particles.displacement[4].x() = std::numeric_limits<double>::quiet_NaN();
  Solver solver = cube.solver();
  EXPECT_FALSE(find_equilibrium(solver).converged);
}

TEST_P(EquilibriumOf, TooFewIterationsAreReported) {
  Solver solver = cantilever(GetParam(), 80, 4, 10.0, 0.0).solver();
  Equilibrium found = find_equilibrium(solver, {.most_iterations = 2});
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.iterations, 2);
  EXPECT_GT(found.residual, 1e-6);
}

TEST(Equilibrium, RefusesSettingsOutOfRange) {
  Solver solver = Specimen(Gradient::linear, Vec3::Constant(0.3), 3, 3, 3, 1000.0).solver();
  EXPECT_THAT(refusal([&] { find_equilibrium(solver, {.tolerance = 0.0}); }),
              testing::HasSubstr("the tolerance of an equilibrium must be in (0, 1), found 0"));
  EXPECT_THAT(refusal([&] { find_equilibrium(solver, {.most_iterations = 0}); }),
              testing::HasSubstr("the iterations to an equilibrium must be at least 1, found 0"));
  std::vector<Vec3> few(3);
  EXPECT_THAT(refusal([&] { solver.static_force(few, few); }),
              testing::HasSubstr("27 particles but 3 displacements and 3 forces"));
  EXPECT_THAT(refusal([&] { solver.place(few); }), testing::HasSubstr("27 particles but 3 displacements"));
}

TEST_P(EquilibriumOf, AskingForForcesElsewhereChangesNoRun) {
  Specimen bar = cantilever(GetParam(), 12, 3, 0.5);
  bar.add("damping");
  bar.add("contact", {{"friction", Curve<double>(0.0)}, {"restitution", Curve<double>(1.0)}});
  Obstacle floor{.name = "floor", .shape = PlaneShape{Vec3(0, 0, 1)}};
  floor.position = Vec3(0, 0, -0.02);
  bar.state.obstacles.push_back(floor);
  bar.add("pressure", {{"value", Curve<double>(100.0)}});
  Solver asked = bar.solver(), left_alone = bar.solver();
  std::vector<Vec3> elsewhere(asked.state().size()), force(asked.state().size());
  for (std::size_t i = 0; i < elsewhere.size(); ++i) elsewhere[i] = 0.1 * asked.state().particles.rest[i];
  for (int frame = 0; frame < 6; ++frame) {
    asked.static_force(elsewhere, force);
    EXPECT_GT(norm(force), 0.0);
    asked.applied_load();
    asked.advance(0.04);
    left_alone.advance(0.04);
  }
  Specimen without_floor = bar;
  without_floor.state.obstacles.clear();
  std::erase_if(without_floor.requests,
                [](const EffectRequest& request) { return request.effect == "contact"; });
  Solver unhindered = without_floor.solver();
  unhindered.advance(0.24);
  EXPECT_LT(lowest(unhindered), -0.02);
  EXPECT_GT(lowest(asked), -0.02);
  EXPECT_EQ(asked.state().particles.displacement, left_alone.state().particles.displacement);
  EXPECT_EQ(asked.state().particles.velocity, left_alone.state().particles.velocity);
  EXPECT_EQ(asked.state().F, left_alone.state().F);
}

}  // namespace
}  // namespace deforma
