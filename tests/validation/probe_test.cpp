#include "pipeline/validation_probe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/validation_case.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

constexpr int n = 4;
const BarSpec bar{.clamped = false};

/// The bar of the cases as the program builds it.
World bar_world(const Scratch& scratch) {
  return build(load_scene(
      scratch.write("bar.toml", bar_scene(bar, {&validation_settings()[0], Placement::lattice, n}))));
}

/// Displaces every particle by a field of its rest position.
template <typename Field>
void place(World& world, const Field& field) {
  std::vector<Vec3> u;
  for (const Vec3& X : world.solver->state().particles.rest) u.push_back(field(X));
  world.solver->place(u);
}

TEST(ValidationProbe, ReadsAnAffineFieldExactly) {
  Scratch scratch;
  World world = bar_world(scratch);
  Mat3 G;
  G << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  G *= 1e-4;
  place(world, [&](const Vec3& X) -> Vec3 { return G * X + Vec3(0.1, 0.2, 0.3); });
  EXPECT_NEAR((face_displacement(*world.solver, 1.0) - Vec3(0.1001, 0.2004, 0.3007)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((face_displacement(*world.solver, 0.0) - Vec3(0.1, 0.2, 0.3)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(ring_displacement(*world.solver, 0.5), 0.10005, 1e-12);
  Mat3 F = Mat3::Identity() + G;
  Eigen::SelfAdjointEigenSolver<Mat3> eigen(0.5 * (F.transpose() * F - Mat3::Identity()));
  EXPECT_NEAR(largest_strain(world.solver->state()), eigen.eigenvalues().cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ValidationProbe, RefusesAPlaneWithoutSurface) {
  Scratch scratch;
  World world = bar_world(scratch);
  EXPECT_THROW(face_displacement(*world.solver, 0.5), std::runtime_error);
  EXPECT_THROW(ring_displacement(*world.solver, 2.0), std::runtime_error);
}

TEST(ValidationProbe, TheTotalLoadOnAnEndIsExact) {
  BarSpec loaded = bar;
  loaded.clamped = true;
  loaded.body =
      "load = { force = [0.25, 0, -2], region = " + region_from(loaded.length, loaded.length) + " }\n";
  Scratch scratch;
  World world = build(load_scene(
      scratch.write("bar.toml", bar_scene(loaded, {&validation_settings()[0], Placement::lattice, n}))));
  std::vector<Vec3> force(world.solver->state().size());
  world.solver->static_force(world.solver->state().particles.displacement, force);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : force) sum += f;
  EXPECT_NEAR((sum - Vec3(0.25, 0, -2)).norm(), 0.0, 1e-12);
}

TEST(ValidationProbe, FindsTheTwistOfABar) {
  Scratch scratch;
  World world = bar_world(scratch);
  place(world, [](const Vec3& X) { return Vec3(0, -1e-3 * X.x() * X.z(), 1e-3 * X.x() * X.y()); });
  EXPECT_NEAR(twist_rate(*world.solver, 0.2, 0.8), 1e-3, 1e-5);
}

TEST(ValidationProbe, TellsModesByTheirShape) {
  Scratch scratch;
  World world = bar_world(scratch);
  const State& state = world.solver->state();
  auto shares = [&](const auto& field) {
    std::vector<Vec3> shape;
    for (const Vec3& X : state.particles.rest) shape.push_back(field(X));
    return section_shares(state, shape, bar.spacing(n));
  };
  auto bending = shares([](const Vec3& X) { return Vec3(0, std::cos(3.0 * X.x()), std::sin(X.x())); });
  EXPECT_NEAR(bending.across, 1.0, 1e-12);
  EXPECT_NEAR(bending.along + bending.twist, 0.0, 1e-12);
  auto torsion = shares([](const Vec3& X) -> Vec3 { return std::cos(X.x()) * Vec3(0, -X.z(), X.y()); });
  EXPECT_NEAR(torsion.twist, 1.0, 1e-12);
  EXPECT_NEAR(torsion.along + torsion.across, 0.0, 1e-12);
  auto axial = shares([](const Vec3& X) { return Vec3(X.x() - 0.5, 0, 0); });
  EXPECT_NEAR(axial.along, 1.0, 1e-12);
}

TEST(ValidationProbe, FindsPeriodMeanAndAmplitude) {
  std::vector<double> times, values;
  for (int k = 0; k <= 120; ++k) {
    times.push_back(0.01 * k);
    values.push_back(-0.05 + 0.05 * std::cos(2.0 * std::numbers::pi * times.back() / 0.3712));
  }
  for (double guess : {0.25, 0.362, 0.6}) {
    Oscillation found = fit_oscillation(times, values, guess);
    EXPECT_NEAR(found.period, 0.3712, 1e-7) << guess;
    EXPECT_NEAR(found.mean, -0.05, 1e-7);
    EXPECT_NEAR(found.amplitude, 0.05, 1e-7);
  }
}

TEST(ValidationProbe, FindsWhenALevelIsReached) {
  const std::vector<double> times = {0, 1, 2, 3}, values = {0, 1, 3, 3};
  EXPECT_DOUBLE_EQ(time_of_level(times, values, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(time_of_level(times, values, 1.5), 1.25);
  EXPECT_THROW(time_of_level(times, values, 4.0), std::runtime_error);
}

}  // namespace
}  // namespace deforma
