#include "sim/effects/damping.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/solver.hpp"

namespace deforma {
namespace {

State cube() { return lattice_box(Vec3::Constant(0.5), 5, 5, 5, 1000.0, 0.2); }

Solver damped(State state, double rate, double viscosity, bool elastic) {
  std::vector<EffectRequest> requests = {
      {"damping",
       {0, given("damping", {{"rate", Curve<double>(rate)}, {"viscosity", Curve<double>(viscosity)}})}}};
  if (elastic) {
    requests.push_back({"elastic", {0, given("elastic", {{"young", Curve<double>(1e5)}})}});
    requests.push_back({"hourglass", {0, given("hourglass")}});
  }
  auto effects = make_effects(state, requests);
  return Solver(std::move(state), std::move(effects), {.max_step = 1e-3});
}

TEST(Damping, RateSlowsAFreeBodyExponentially) {
  State state = cube();
  for (Vec3& v : state.particles.velocity) v = Vec3(2, 0, 0);
  Solver solver = damped(std::move(state), 3.0, 0.0, false);
  solver.advance(1.0);
  // v / (1 + rate dt) each step, exactly.
  EXPECT_NEAR(solver.state().particles.velocity[7].x(), 2.0 * std::pow(1.0 + 3.0e-3, -1000), 1e-12);
}

TEST(Damping, ViscosityLeavesRigidMotionAlone) {
  State state = cube();
  Vec3 centre = Vec3::Zero();
  for (const Vec3& X : state.particles.rest) centre += X / static_cast<double>(state.size());
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.velocity[i] = Vec3(1, 2, 3) + Vec3(0, 0, 0.02).cross(state.particles.rest[i] - centre);
  Solver solver = damped(std::move(state), 0.0, 50.0, true);
  Ledger before = solver.ledger();
  solver.advance(0.5);
  Ledger after = solver.ledger();
  EXPECT_LT((after.linear_momentum - before.linear_momentum).norm(), 1e-12 * before.linear_momentum.norm());
  EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(), 1e-9 * before.angular_momentum.norm());
  EXPECT_NEAR(after.kinetic, before.kinetic, 1e-9 * before.kinetic);
}

TEST(Damping, ViscosityTakesEnergyFromDeformationAndNeverGivesAny) {
  State state = cube();
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.displacement[i].z() = 0.1 * state.particles.rest[i].z();
  Solver solver = damped(std::move(state), 0.0, 300.0, true);
  double start = solver.ledger().total(), before = start;
  for (int frame = 0; frame < 40; ++frame) {
    solver.advance(0.025);
    double now = solver.ledger().total();
    EXPECT_LT(now, before + 1e-3 * start);
    before = now;
  }
  EXPECT_LT(before, 0.02 * start);
}

TEST(Damping, ViscousStressOpposesTheRateOfStrain) {
  State state = cube();
  scramble(state, 0.02);
  std::vector<EffectRequest> requests = {
      {"damping", {0, given("damping", {{"viscosity", Curve<double>(10.0)}})}}};
  auto effects = make_effects(state, requests);
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  scramble(state, 0.5, 23);
  state.F_rate.resize(state.size());
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F_rate);
  std::vector<Mat3> P(state.size(), Mat3::Zero());
  std::vector<double> none(state.size());
  add_stress(state, effects, P, none);
  for (std::size_t i = 0; i < state.size(); ++i) {
    EXPECT_GT(P[i].cwiseProduct(state.F_rate[i]).sum(), 0.0);
    Mat3 tau = P[i] * state.F[i].transpose();
    EXPECT_LT((tau - tau.transpose()).norm(), 1e-12 * tau.norm());
  }
}

}  // namespace
}  // namespace deforma
