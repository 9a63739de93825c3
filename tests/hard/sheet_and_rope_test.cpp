#include <gmock/gmock.h>

#include "pipeline/build.hpp"
#include "sim/material.hpp"
#include "tests/hard/bodies.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using namespace hard;

// 6 x 6 particles in one layer.
State sheet_particles() {
  return lattice_particles(Vec3(6 * spacing, 6 * spacing, spacing), 6, 6, 1, density);
}

// Noise of up to `amount` across the layer.
void roughen(State& state, double amount) {
  std::mt19937 generator(3);
  for (Vec3& X : state.particles.rest) X.z() += (generator() / 2147483648.0 - 1.0) * amount;
}

std::vector<Mat3> stress_at(State& state, const std::vector<EffectRequest>& requests) {
  auto effects = make_effects(state, requests);
  refresh(state, effects);
  std::vector<Mat3> P(state.size(), Mat3::Zero());
  std::vector<double> pair_stiffness(state.size(), 0.0);
  add_stress(state, effects, P, pair_stiffness);
  return P;
}

TEST(HardCase, Row01OneLayerSheetInAnyOrientation) {
  std::mt19937 generator(1);
  for (Gradient gradient : both_fits) {
    for (int orientation = 0; orientation < 6; ++orientation) {
      State state = sheet_particles();
      const Mat3 turn = orientation == 0 ? Mat3(Mat3::Identity()) : random_rotation(generator);
      pose_rest(state, turn);
      prepare(state, gradient);
      EXPECT_EQ(state.fit.count_below(3), 36u);
      EXPECT_EQ(state.fit.count_below(2), 0u);

      const Mat3 bend = Eigen::AngleAxisd(1.3, random_direction(generator)).toRotationMatrix();
      move_rigidly(state, bend);
      auto effects = make_effects(state, elastic(gradient));
      EXPECT_LT(largest_norm(total_force(state, effects)), 1e-9 * young * spacing * spacing);

      const double e = 1e-4;
      const Vec3 along = turn.col(0);
      for (std::size_t i = 0; i < state.size(); ++i)
        state.particles.displacement[i] = e * along.dot(state.particles.rest[i]) * along;
      const double expected = young / (1.0 - poisson * poisson) * e;
      for (const Mat3& P : stress_at(state, elastic(gradient)))
        EXPECT_NEAR(along.dot(P * along), expected, 0.01 * expected);
    }
    for (int orientation = 0; orientation < 3; ++orientation) {
      State state = sheet_particles();
      pose_rest(state, random_rotation(generator));
      prepare(state, gradient);
      agitate(state, 0.02 * wave_speed());
      Solver solver = make_solver(std::move(state), elastic(gradient));
      take_steps(solver, 10000);
      EXPECT_TRUE(finite_everywhere(solver.state()));
    }
  }
}

TEST(HardCase, Row01OneLayerSheetIsReportedWithTheCount) {
  const Scratch scratch;
  const World world =
      build(load_scene(scratch.write("sheet.toml",
                                     "duration = 1\nfps = 10\n[[body]]\nname = \"sheet\"\nshape = { type = "
                                     "\"box\", size = [0.6, 0.6, 0.1] }\n"
                                     "spacing = 0.1\ndensity = 1000\nelastic = { young = 1e6 }\n")));
  EXPECT_THAT(world.warnings, testing::Contains(testing::HasSubstr("36 of 36 particles")));
}

TEST(HardCase, Row02NearlyFlatSheet) {
  for (Gradient gradient : both_fits)
    for (double noise = 0.1; noise > 0.5e-8; noise *= 0.1) {
      SCOPED_TRACE(testing::Message() << gradient_name(gradient) << ", noise " << noise << " d");
      State state = sheet_particles();
      roughen(state, noise * spacing);
      prepare(state, gradient);
      stir(state, 1e-2 * wave_speed(), 6 * spacing);
      Solver solver = make_solver(std::move(state), elastic(gradient));
      const double drift = energy_drift(solver, 10000);
      EXPECT_TRUE(finite_everywhere(solver.state()));
      EXPECT_GT(solver.statistics().smallest_step, 1e-3 * spacing / wave_speed());
      EXPECT_LT(drift, 0.01);
    }
}

TEST(HardCase, Row03RopeOfTwelve) {
  std::mt19937 generator(4);
  for (Gradient gradient : both_fits)
    for (int orientation = 0; orientation < 4; ++orientation) {
      State state = lattice_particles(Vec3(12 * spacing, spacing, spacing), 12, 1, 1, density);
      const Mat3 turn = orientation == 0 ? Mat3(Mat3::Identity()) : random_rotation(generator);
      pose_rest(state, turn);
      prepare(state, gradient);
      EXPECT_EQ(state.fit.count_below(2), 12u);
      EXPECT_EQ(state.fit.count_below(1), 0u);

      const double e = 1e-4;
      const Vec3 along = turn.col(0);
      for (std::size_t i = 0; i < state.size(); ++i)
        state.particles.displacement[i] = e * along.dot(state.particles.rest[i]) * along;
      for (const Mat3& P : stress_at(state, elastic(gradient))) {
        EXPECT_NEAR(along.dot(P * along), young * e, 1e-3 * young * e);
        EXPECT_LT((P - along.dot(P * along) * along * along.transpose()).norm(), 1e-9 * young * e)
            << "axial force only";
      }
      move_rigidly(state, random_rotation(generator), Vec3(3, -2, 1));
      auto effects = make_effects(state, elastic(gradient));
      EXPECT_LT(largest_norm(total_force(state, effects)), 1e-9 * young * spacing * spacing);
    }
}

}  // namespace
}  // namespace deforma
