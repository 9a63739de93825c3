#include "tests/hard/bodies.hpp"

#include "sim/effects/lennard_jones.hpp"

namespace deforma {
namespace {

using namespace hard;

EffectRequest lennard_jones(Index body, double depth, double radius, bool self = false) {
  return {
      "lennard_jones",
      {body, given("lennard_jones",
                   {{"depth", Curve<double>(depth)}, {"radius", Curve<double>(radius)}, {"self", self}})}};
}

State pair_at(double distance, const Vec3& direction) {
  State state = lattice_particles(Vec3::Constant(spacing), 1, 1, 1, density);
  pose_rest(state, Mat3::Identity(),
            -state.particles.rest[0]);  // at the origin, where 1e-30 m are not rounded away
  append_body(state, State(state), Vec3::Zero());
  prepare_state(state, {});
  state.particles.displacement[1] = distance * direction;
  return state;
}

TEST(HardCase, Row19LennardJonesPairOnTopOfEachOther) {
  const double alpha = spacing, depth = 0.05;
  const std::vector<EffectRequest> requests = {lennard_jones(0, depth, alpha),
                                               lennard_jones(1, depth, alpha)};
  std::mt19937 generator(8);
  for (double distance : {0.0, 1e-30, 1e-6 * alpha})
    for (int k = 0; k < 10; ++k) {
      SCOPED_TRACE(distance);
      const Vec3 direction = random_direction(generator);
      State state = pair_at(distance, direction);
      auto effects = make_effects(state, requests);
      const std::vector<Vec3> force = total_force(state, effects);
      ASSERT_TRUE(force[0].allFinite());
      EXPECT_EQ(force[0], Vec3(-force[1]));
      EXPECT_NEAR(force[0].norm(), -depth / alpha * LennardJonesPotential::slope(0.0), 1e-9) << "capped";
      const Vec3 expected = distance > 0.0 ? direction : Vec3(-Vec3::UnitX());
      EXPECT_LT((force[1].normalized() - expected).norm(), 1e-9) << "along the line, or along x";
      Solver solver(std::move(state), std::move(effects), {});
      for (int step = 0; step < 1000; ++step) {
        solver.advance(solver.stable_step());
        ASSERT_EQ(solver.ledger().linear_momentum, Vec3(0, 0, 0));
      }
      EXPECT_TRUE(finite_everywhere(solver.state()));
    }
  for (double speed : {0.3, 1.0, 5.0})
    for (int k = 0; k < 10; ++k) {
      SCOPED_TRACE(speed);
      const Vec3 direction = random_direction(generator);
      State state = pair_at(4 * alpha, direction);
      state.particles.velocity[0] = speed * direction;
      state.particles.velocity[1] = -speed * direction;
      Solver solver = make_solver(std::move(state), requests);
      const double before = solver.ledger().total();
      solver.advance(4 * alpha / speed);
      EXPECT_NEAR(solver.ledger().total(), before, 0.01 * before);
      EXPECT_EQ(solver.ledger().linear_momentum, Vec3(0, 0, 0));
    }
}

TEST(HardCaseSlow, Row20LennardJonesInsideABodyAtRest) {
  for (Gradient gradient : both_fits)
    for (auto [alpha, jitter] :
         {std::pair(0.8 * spacing, 0.0), {spacing, 0.2}}) {  // 0.8: pairs exactly at the cut
      Solver solver =
          make_solver(cube(gradient, jitter), elastic(gradient) + lennard_jones(0, 0.01, alpha, true));
      take_steps(solver, 10000);
      EXPECT_LT(largest_norm(solver.state().particles.displacement), 1e-6 * spacing) << alpha;
    }
}

TEST(HardCase, Row21LennardJonesOverlapAtTheStart) {
  for (Gradient gradient : both_fits)
    for (double overlap : {0.05, 0.5, 1.0}) {  // of the second body's place in the first, spacings
      SCOPED_TRACE(testing::Message() << gradient_name(gradient) << ", " << overlap);
      State state = lattice_particles(Vec3::Constant(4 * spacing), 4, 4, 4, density, 0.1);
      append_body(state, lattice_particles(Vec3::Constant(4 * spacing), 4, 4, 4, density, 0.2),
                  Vec3((4 - overlap) * spacing, 0.4 * spacing, -0.3 * spacing));
      prepare(state, gradient);
      std::vector<EffectRequest> requests = elastic(gradient, 0);
      for (const EffectRequest& request : elastic(gradient, 1)) requests.push_back(request);
      for (Index body : {0, 1}) requests.push_back(lennard_jones(body, 0.05, spacing));
      const double mass = state.particles.mass[0];
      Solver solver = make_solver(std::move(state), requests);
      const double energy = solver.ledger().total();
      ASSERT_GT(energy, 0.0);
      double fastest = 0.0;
      for (int k = 0; k < 5000; ++k) {
        solver.advance(solver.stable_step());
        fastest = std::max(fastest, largest_norm(solver.state().particles.velocity));
      }
      EXPECT_LT(fastest, std::sqrt(2.0 * energy / mass));
      EXPECT_LT(fastest, wave_speed());
      EXPECT_TRUE(finite_everywhere(solver.state()));
      Vec3 apart = Vec3::Zero();
      const State& end = solver.state();
      for (std::size_t i = 0; i < end.size(); ++i)
        apart += (i < 64 ? -1.0 : 1.0) / 64.0 * end.particles.displacement[i];
      EXPECT_GT(apart.x(), 0.0) << "pushed apart";
    }
}

}  // namespace
}  // namespace deforma
