#include "sim/effects/lennard_jones.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/solver.hpp"

namespace deforma {
namespace {

EffectRequest lennard_jones_of(Index body, double depth, double radius, bool self = false) {
  return {
      "lennard_jones",
      {body, given("lennard_jones",
                   {{"depth", Curve<double>(depth)}, {"radius", Curve<double>(radius)}, {"self", self}})}};
}

// Two bodies of one particle of 1 kg each, `apart` from each other.
State two_particles(const Vec3& apart) {
  State state = lattice_particles(Vec3::Constant(0.1), 1, 1, 1, 1000.0);
  append_body(state, State(state), apart);
  prepare_state(state, {});
  return state;
}

// Two clouds of 8 particles each, the first partly within the second.
State two_clouds() {
  State state = lattice_particles(Vec3::Constant(0.2), 2, 2, 2, 1000.0, 0.2);
  append_body(state, lattice_particles(Vec3::Constant(0.22), 2, 2, 2, 800.0, 0.2), Vec3(0.09, 0.13, 0.05));
  prepare_state(state, {});
  return state;
}

TEST(LennardJones, TheWellIsWhereTheFormulaPutsIt) {
  const double minimum = std::pow(2.0, 1.0 / 6.0);
  EXPECT_NEAR(LennardJonesPotential::slope(minimum), 0.0, 1e-12);
  EXPECT_NEAR(LennardJonesPotential::curvature(minimum), 57.146, 1e-3);
  EXPECT_NEAR(LennardJonesPotential::energy(minimum), -1.0 + 0.016316891136,
              1e-12);  // less what it has at the cut
  EXPECT_EQ(LennardJonesPotential::energy(2.5), 0.0);
  EXPECT_EQ(LennardJonesPotential::slope(2.6), 0.0);
}

TEST(LennardJones, EnergyAndForceAreContinuousAtTheCap) {
  const double cap = LennardJonesPotential::cap;
  EXPECT_NEAR(LennardJonesPotential::energy(cap - 1e-9), LennardJonesPotential::energy(cap + 1e-9), 1e-4);
  EXPECT_NEAR(LennardJonesPotential::slope(cap - 1e-9) / LennardJonesPotential::slope(cap + 1e-9), 1.0, 1e-6);
  EXPECT_DOUBLE_EQ(LennardJonesPotential::slope(0.0), LennardJonesPotential::slope(cap));
  for (double r : {0.3, 0.7, 0.9, 1.1, 1.9}) {
    double slope = (LennardJonesPotential::energy(r + 1e-5) - LennardJonesPotential::energy(r - 1e-5)) / 2e-5;
    EXPECT_NEAR(slope, LennardJonesPotential::slope(r), 1e-6 * std::abs(slope) + 1e-8);
  }
}

TEST(LennardJones, TheForceIsTheGradientOfTheEnergyInsideAndOutsideTheCap) {
  for (double radius : {0.05, 0.1, 0.2}) {  // 0.2: many pairs are within the cap
    State state = two_clouds();
    auto effects = make_effects(
        state, std::vector{lennard_jones_of(0, 0.3, radius), lennard_jones_of(1, 0.5, 0.8 * radius)});
    EXPECT_LT(gradient_error(state, effects, 1e-6), 1e-6) << radius;
  }
}

TEST(LennardJones, PairsKeepTheirMomentumExactlyAtAnyDistance) {
  for (double distance : {0.0, 1e-300, 1e-30, 1e-7, 0.05, 0.11, 0.24}) {
    State state = two_particles(Vec3::Zero());
    state.particles.displacement[1] = distance * Vec3(0.6, 0.0, 0.8);
    auto effects =
        make_effects(state, std::vector{lennard_jones_of(0, 0.3, 0.1), lennard_jones_of(1, 0.3, 0.1)});
    std::vector<Vec3> force = total_force(state, effects);
    EXPECT_EQ(force[0], Vec3(-force[1])) << distance;
    EXPECT_TRUE(force[0].allFinite());
    if (distance < 0.08) {
      EXPECT_NEAR(force[0].norm(), -3.0 * LennardJonesPotential::slope(0.0), 1e-9);
    }
  }
}

TEST(LennardJones, AHeadOnCollisionKeepsItsEnergy) {
  State state = two_particles(Vec3(0.4, 0, 0));
  state.particles.velocity[0] = Vec3(1.0, 0, 0);
  state.particles.velocity[1] = Vec3(-1.0, 0, 0);
  auto effects =
      make_effects(state, std::vector{lennard_jones_of(0, 0.05, 0.1), lennard_jones_of(1, 0.05, 0.1)});
  Solver solver(std::move(state), std::move(effects), {.integrator = Integrator::velocity_verlet});
  const double before = solver.ledger().total();
  solver.advance(0.4);
  EXPECT_NEAR(solver.ledger().total(), before, 0.01 * before);
  EXPECT_LT(solver.state().particles.velocity[0].x(), -0.99);
  EXPECT_EQ(solver.ledger().linear_momentum, Vec3(0, 0, 0));
}

TEST(LennardJones, ParticlesOnOneAnotherArePushedApartGently) {
  State state = two_clouds();
  auto effects =
      make_effects(state, std::vector{lennard_jones_of(0, 1e-3, 0.1), lennard_jones_of(1, 1e-3, 0.1)});
  Solver solver(std::move(state), std::move(effects), {});
  const double overlap = solver.ledger().total();
  ASSERT_GT(overlap, 0.0);
  for (int frame = 0; frame < 50; ++frame) {
    solver.advance(0.1);
    for (std::size_t i = 0; i < solver.state().size(); ++i)
      ASSERT_LT(solver.state().particles.velocity[i].norm(),
                std::sqrt(2.0 * overlap / solver.state().particles.mass[i]));
  }
  EXPECT_NEAR(solver.ledger().total(), overlap, 0.01 * overlap);
  EXPECT_GT(solver.ledger().kinetic, 0.5 * overlap);
}

TEST(LennardJones, ABodyAtRestStaysAtRest) {
  State state = lattice_box(Vec3::Constant(0.6), 6, 6, 6, 1000.0);
  std::vector<EffectRequest> requests = {
      {"elastic", {0, given("elastic", {{"young", Curve<double>(1e6)}})}},
      {"hourglass", {0, given("hourglass")}},
      lennard_jones_of(0, 0.01, 0.08, true)};  // some pairs are exactly at the cut, 2 spacings
  auto effects = make_effects(state, requests);
  Solver solver(std::move(state), std::move(effects), {.max_step = 1e-4});
  solver.advance(1.0);
  double largest = 0.0;
  for (const Vec3& u : solver.state().particles.displacement) largest = std::max(largest, u.norm());
  EXPECT_LT(largest, 1e-6 * 0.1);
}

TEST(LennardJones, WithinABodyItActsOnWhatWasFarApart) {
  State state = lattice_box(Vec3(1.0, 0.1, 0.1), 10, 1, 1, 1000.0);
  std::size_t last = state.size() - 1;
  state.particles.displacement[last] = state.particles.rest[0] + Vec3(0, 0, 0.1) - state.particles.rest[last];
  for (bool self : {false, true}) {
    auto effects = make_effects(state, std::vector{lennard_jones_of(0, 0.3, 0.1, self)});
    std::vector<Vec3> force = total_force(state, effects);
    EXPECT_EQ(force[last].norm() > 1.0, self);
    EXPECT_EQ(force[4].norm(), 0.0);
  }
}

TEST(LennardJones, RefusesANegativeDepth) {
  try {
    given("lennard_jones", {{"depth", Curve<double>(-1.0)}});
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("depth"));
  }
}

}  // namespace
}  // namespace deforma
