#include "sim/effects/pressure.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/solver.hpp"

namespace deforma {
namespace {

State cube() { return lattice_box(Vec3::Constant(0.5), 5, 5, 5, 1000.0, 0.2); }

EffectRequest pressure_of(const Curve<double>& value) {
  return {"pressure", {0, given("pressure", {{"value", value}})}};
}

TEST(Pressure, TheForceIsTheGradientOfPressureTimesVolume) {
  for (double value : {1e5, -2e4}) {
    State state = cube();
    scramble(state, 0.02);
    auto effects = make_effects(state, std::vector{pressure_of(value)});
    EXPECT_LT(gradient_error(state, effects, 1e-4), 1e-6);
  }
}

TEST(Pressure, OfABodyAtRestTheEnergyIsPressureTimesVolume) {
  State state = cube();
  auto effects = make_effects(state, std::vector{pressure_of(1e5)});
  EXPECT_NEAR(total_energy(state, effects), 1e5 * 0.125, 1e-6);
  for (Vec3& u : state.particles.displacement) u = Vec3(3e4, -1e4, 2e4);  // and far away it is the same
  EXPECT_NEAR(total_energy(state, effects), 1e5 * 0.125, 1e-3);
}

TEST(Pressure, NeitherPushesNorTurnsAClosedBody) {
  State state = cube();
  scramble(state, 0.02);
  auto effects = make_effects(state, std::vector{pressure_of(1e5)});
  std::vector<Vec3> force = total_force(state, effects);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  double size = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    sum += force[i];
    torque += state.particles.position(i).cross(force[i]);
    size += force[i].norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * size);
  EXPECT_LT(torque.norm(), 1e-12 * size);
}

TEST(Pressure, ChangesTheVolumeByTheBulkModulus) {
  State state = lattice_box(Vec3::Constant(0.5), 5, 5, 5, 1000.0);
  const double young = 1e6, poisson = 0.3, bulk = young / (3.0 * (1.0 - 2.0 * poisson));
  std::vector<EffectRequest> requests = {
      {"elastic",
       {0, given("elastic", {{"young", Curve<double>(young)}, {"poisson", Curve<double>(poisson)}})}},
      {"hourglass", {0, given("hourglass")}},
      {"damping", {0, given("damping", {{"rate", Curve<double>(60.0)}})}},
      pressure_of(0.01 * bulk)};
  auto effects = make_effects(state, requests);
  Solver solver(std::move(state), std::move(effects), {});
  solver.advance(1.0);
  double trace = 0.0;
  for (const Mat3& F : solver.state().F) trace += (F.determinant() - 1.0) / 125.0;
  EXPECT_NEAR(trace, -0.01, 0.0015);
}

TEST(Pressure, FollowsItsKeyframes) {
  State state = cube();
  Curve<double> ramp(std::vector<Curve<double>::Key>{{0.0, 0.0}, {2.0, 4e4}});
  auto effects = make_effects(state, std::vector{pressure_of(ramp)});
  EXPECT_EQ(total_energy(state, effects), 0.0);
  state.time = 1.0;
  EXPECT_NEAR(total_energy(state, effects), 2e4 * 0.125, 1e-6);
}

}  // namespace
}  // namespace deforma
