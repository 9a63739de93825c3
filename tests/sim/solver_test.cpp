#include "sim/solver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "fixtures.hpp"
#include "gradient_check.hpp"

namespace deforma {
namespace {

std::vector<EffectRequest> elastic_requests(double young = 1e6, double poisson = 0.3) {
  return {{"elastic",
           {0, given("elastic", {{"young", Curve<double>(young)}, {"poisson", Curve<double>(poisson)}})}},
          {"hourglass", {0, given("hourglass")}}};
}

Solver make_solver(State state, const std::vector<EffectRequest>& requests,
                   const SolverSettings& settings = {}) {
  auto effects = make_effects(state, requests);
  return Solver(std::move(state), std::move(effects), settings);
}

State cube(double jitter = 0.0) { return lattice_box(Vec3::Constant(0.6), 6, 6, 6, 1000.0, jitter); }

double largest_displacement(const State& state) {
  double largest = 0.0;
  for (const Vec3& u : state.particles.displacement) largest = std::max(largest, u.norm());
  return largest;
}

TEST(Solver, LeavesABodyAtRestExactlyAtRest) {
  Solver solver = make_solver(cube(0.2), elastic_requests());
  solver.advance(1.0);
  EXPECT_EQ(largest_displacement(solver.state()), 0.0);
  EXPECT_GT(solver.statistics().substeps, 100u);
}

TEST(Solver, MeasuresTheStepLimitInTermsOfSpacingOverWaveSpeed) {
  // 1.13 d/c is the limit measured by time stepping for k = 18 and zeta = 1 (poly6); the spline's is near it.
  SolverSettings settings{.step_fraction = 1.0};
  Solver solver = make_solver(cube(), elastic_requests(), settings);
  double c = std::sqrt(1e6 * 1.3461538461538463 / 1000.0);
  EXPECT_NEAR(solver.stable_step() * c / 0.1, 1.13, 0.12);
}

TEST(Solver, KeepsEnergyAndMomentaOfAFreelySpinningCube) {
  State state = cube(0.1);
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.velocity[i] = Vec3(0.3, 2.0, 1.0).cross(state.particles.rest[i]) + Vec3(1, 0, 0);
  Solver solver = make_solver(std::move(state), elastic_requests());
  Ledger before = solver.ledger();
  solver.advance(2.0);
  Ledger after = solver.ledger();
  EXPECT_LT((after.linear_momentum - before.linear_momentum).norm(), 1e-12 * before.linear_momentum.norm());
  EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(), 1e-9 * before.angular_momentum.norm());
  EXPECT_NEAR(after.total(), before.total(), 1e-3 * before.total());
}

TEST(Solver, FallsAsItsIntegratorSays) {
  for (Integrator integrator : {Integrator::symplectic_euler, Integrator::velocity_verlet}) {
    State state = cube();
    SolverSettings settings{.integrator = integrator, .max_step = 1e-3};
    Solver solver = make_solver(std::move(state), {{"gravity", {0, given("gravity")}}}, settings);
    solver.advance(0.1);
    double n = 100, dt = 1e-3, g = 9.81;
    double expected =
        integrator == Integrator::symplectic_euler ? g * dt * dt * n * (n + 1) / 2 : g * 0.1 * 0.1 / 2;
    EXPECT_NEAR(-solver.state().particles.displacement[0].z(), expected, 1e-12 * expected);
    EXPECT_DOUBLE_EQ(solver.state().time, 0.1);
  }
}

TEST(Solver, BothIntegratorsRecoverASquashedCube) {
  for (Integrator integrator : {Integrator::symplectic_euler, Integrator::velocity_verlet}) {
    State state = cube(0.1);
    for (std::size_t i = 0; i < state.size(); ++i)
      state.particles.displacement[i].z() = -0.8 * state.particles.rest[i].z();
    auto requests = elastic_requests();
    requests.push_back({"damping", {0, given("damping", {{"rate", Curve<double>(20.0)}})}});
    Solver solver = make_solver(std::move(state), requests, {.integrator = integrator});
    solver.advance(2.0);
    const State& end = solver.state();
    double distance = (end.particles.position(215) - end.particles.position(0)).norm();
    double rest = (end.particles.rest[215] - end.particles.rest[0]).norm();
    EXPECT_NEAR(distance, rest, 1e-4 * rest);
  }
}

TEST(Solver, MeasuresAgainWhenAPropertyJumps) {
  auto requests = elastic_requests();
  requests[0].table.parameters.set(
      "young", Curve<double>(std::vector<Curve<double>::Key>{{0.0, 1e6}, {0.1, 1e6}, {0.11, 1e8}}));
  Solver solver = make_solver(cube(), requests);
  double soft = solver.stable_step();
  solver.advance(0.2);
  EXPECT_NEAR(solver.stable_step(), soft / 10.0, 0.02 * soft);
}

TEST(Solver, APinnedBarSagsTheSameWhateverTheStep) {
  std::vector<double> sag;
  for (double step : {4e-4, 1e-4}) {
    State state = lattice_box(Vec3(0.4, 0.2, 0.2), 4, 2, 2, 1000.0);
    auto requests = elastic_requests(1e5, 0.0);
    requests.push_back({"gravity", {0, given("gravity", {{"acceleration", Curve<Vec3>(Vec3(9.81, 0, 0))}})}});
    requests.push_back({"damping", {0, given("damping", {{"rate", Curve<double>(30.0)}})}});
    Region end;
    end.max.x() = 0.1;
    requests.push_back({"pin", {0, given("pin", {{"region", end}})}});
    Solver solver = make_solver(std::move(state), requests, {.max_step = step});
    solver.advance(3.0);
    sag.push_back(solver.state().particles.displacement.back().x());
  }
  EXPECT_GT(sag[0], 1e-4);
  EXPECT_NEAR(sag[0], sag[1], 1e-6 * sag[0]);
}

TEST(Solver, MeasuresAgainWhenAPinLetsGo) {
  auto requests = elastic_requests();
  requests.push_back({"pin", {0, given("pin", {{"release", Curve<double>(0.1)}})}});
  Solver held = make_solver(cube(), requests);
  Solver loose = make_solver(cube(), elastic_requests());
  EXPECT_GT(held.stable_step(), 1.0);
  held.advance(0.2);
  EXPECT_NEAR(held.stable_step(), loose.stable_step(), 0.02 * loose.stable_step());
}

TEST(Solver, SeesAnotherBodyBecomeTheStiffest) {
  State state = lattice_particles(Vec3::Constant(0.4), 4, 4, 4, 1000.0);
  append_body(state, lattice_particles(Vec3::Constant(0.4), 4, 4, 4, 1000.0), Vec3(1, 0, 0));
  prepare_state(state, {});
  // One softens as much as the other stiffens: the sum of what changes does not.
  std::vector<Curve<double>::Key> down = {{0.0, 1e6}, {1.0, 1e4}}, up = {{0.0, 1e4}, {1.0, 1e6}};
  std::vector<EffectRequest> requests = {{"elastic", {0, given("elastic", {{"young", Curve<double>(down)}})}},
                                         {"elastic", {1, given("elastic", {{"young", Curve<double>(up)}})}},
                                         {"hourglass", {0, given("hourglass")}},
                                         {"hourglass", {1, given("hourglass")}}};
  Solver solver = make_solver(std::move(state), requests);
  double start = solver.stable_step();
  solver.advance(1.0);
  EXPECT_NEAR(solver.stable_step(), start, 0.04 * start);
}

TEST(Solver, CountsOnlyTheStagesThatAnEffectTakesPartIn) {
  auto requests = elastic_requests();
  requests.push_back({"gravity", {0, given("gravity")}});
  Solver solver = make_solver(cube(), requests);
  solver.advance(0.1);
  const auto& statistics = solver.statistics();
  EXPECT_EQ(statistics.effects[2].name, "gravity");
  EXPECT_EQ(statistics.effects[2].calls,
            statistics.substeps + 1);  // one force a substep, and one to begin with
}

TEST(Solver, GoesOnFromWhereParticlesWerePut) {
  for (Gradient gradient : {Gradient::linear, Gradient::quadratic}) {
    NeighborhoodSettings settings;
    if (gradient == Gradient::quadratic) settings = {.neighbors = 30, .support = 1.7};
    State state = lattice_box(Vec3::Constant(0.4), 4, 4, 4, 1000.0, 0.0, settings, gradient);
    for (Vec3& v : state.particles.velocity) v = Vec3(1e-3, 0, 0);
    Solver solver = make_solver(std::move(state), elastic_requests(), {.step_fraction = 0.05});
    solver.advance(0.05);
    std::vector<Vec3> stretched;
    for (const Vec3& X : solver.state().particles.rest) stretched.push_back(0.1 * X);
    solver.place(stretched);
    const double energy = solver.ledger().total();
    EXPECT_NO_THROW(solver.advance(0.05));
    EXPECT_NEAR(solver.ledger().total(), energy, 0.02 * energy);
  }
}

TEST(Solver, ReportsOnlyTheEffectsThatItHas) {
  Solver solver = make_solver(cube(), elastic_requests());
  solver.advance(0.01);
  std::vector<std::string> names;
  for (const auto& pass : solver.statistics().effects) names.push_back(pass.name);
  EXPECT_THAT(names, testing::ElementsAre("elastic", "hourglass"));
  EXPECT_GT(solver.statistics().effects[0].calls, 0u);
}

TEST(Solver, StopsWithAMessageWhenTheStateIsNoLongerFinite) {
  State state = cube();
  state.particles.velocity[17].x() = 1e300;
  Solver solver = make_solver(std::move(state), elastic_requests());
  try {
    solver.advance(0.1);
    FAIL() << "expected SimulationDiverged";
  } catch (const SimulationDiverged& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("body 'box', particle"));
    EXPECT_THAT(error.what(), testing::HasSubstr("step_fraction"));
  }
}

TEST(Solver, StopsWithAMessageWhenTheStepVanishes) {
  Solver solver = make_solver(cube(), elastic_requests(1e40));
  try {
    solver.advance(1.0);
    FAIL() << "expected SimulationDiverged";
  } catch (const SimulationDiverged& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("its stable step has fallen to"));
  }
}

TEST(Solver, RefusesSettingsOutOfRange) {
  for (double fraction : {0.0, -1.0, 1.5, std::nan("")})
    EXPECT_THROW(make_solver(cube(), {}, {.step_fraction = fraction}), std::invalid_argument);
  EXPECT_THROW(make_solver(cube(), {}, {.max_step = -1.0}), std::invalid_argument);
  Solver solver = make_solver(cube(), {});
  EXPECT_THROW(solver.advance(-1.0), std::invalid_argument);
}

}  // namespace
}  // namespace deforma
