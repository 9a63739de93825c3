#include "tests/hard/bodies.hpp"

namespace deforma {
namespace {

using namespace hard;

TEST(HardCase, Row04OneParticle) {
  const double g = 9.81;
  for (Gradient gradient : both_fits)
    for (Integrator integrator : {Integrator::symplectic_euler, Integrator::velocity_verlet}) {
      State state = lattice_particles(Vec3::Constant(spacing), 1, 1, 1, density);
      prepare(state, gradient);
      const double dt = 1e-3;
      Solver falling = make_solver(std::move(state), elastic(gradient) + gravity(Vec3(0, 0, -g)),
                                   {.integrator = integrator, .max_step = dt});
      for (int n = 1; n <= 1000; ++n) {
        falling.advance(dt);
        const double expected = integrator == Integrator::symplectic_euler ? 0.5 * g * dt * dt * n * (n + 1.0)
                                                                           : 0.5 * g * dt * dt * n * n;
        ASSERT_NEAR(-falling.state().particles.displacement[0].z(), expected, 1e-12 * expected);
      }
      EXPECT_EQ(falling.statistics().substeps, 1000u);
      EXPECT_TRUE(finite_everywhere(falling.state()));

      State other = lattice_particles(Vec3::Constant(spacing), 1, 1, 1, density);
      pose_rest(other, Mat3::Identity(), Vec3(0, 0, 0.5));
      other.obstacles.push_back({.name = "floor", .shape = PlaneShape{}});
      prepare(other, gradient);
      Solver colliding = make_solver(
          std::move(other),
          elastic(gradient) + gravity(Vec3(0, 0, -g)) + EffectRequest{"contact", {0, given("contact")}},
          {.integrator = integrator});
      double lowest = 1.0, fastest_up = 0.0;
      for (int frame = 0; frame < 500; ++frame) {
        colliding.advance(0.01);
        lowest = std::min(lowest, colliding.state().particles.position(0).z());
        fastest_up = std::max(fastest_up, colliding.state().particles.velocity[0].z());
      }
      EXPECT_GT(lowest, -0.5 * spacing);
      EXPECT_LT(lowest, 2.0 * spacing) << "it reached the floor";
      EXPECT_GT(fastest_up, 0.0) << "it bounced";
      EXPECT_LT(colliding.state().particles.position(0).z(), 2.0 * spacing) << "and stays there";
      EXPECT_TRUE(finite_everywhere(colliding.state()));
    }
}

TEST(HardCase, Row05BodiesOfTwoAndThreeParticles) {
  for (Gradient gradient : both_fits)
    for (int count : {2, 3}) {
      State state = lattice_particles(Vec3(count * spacing, spacing, spacing), count, 1, 1, density);
      if (count == 3) state.particles.rest[2] += Vec3(-0.5 * spacing, 0.8 * spacing, 0.3 * spacing);
      prepare(state, gradient);
      for (std::size_t i = 0; i < state.size(); ++i)
        EXPECT_EQ(state.links.row(i).size(), static_cast<Index>(count - 1)) << "k is clipped to N-1";
      agitate(state, 0.02 * wave_speed());
      for (Vec3& v : state.particles.velocity) v += Vec3(1, -2, 0.5);
      Solver solver = make_solver(std::move(state), elastic(gradient));
      const Ledger before = solver.ledger();
      double size = 0.0;
      for (std::size_t i = 0; i < solver.state().size(); ++i)
        size += solver.state().particles.mass[i] * solver.state().particles.velocity[i].norm();
      take_steps(solver, 10000);
      const Ledger after = solver.ledger();
      EXPECT_TRUE(finite_everywhere(solver.state()));
      EXPECT_LT((after.linear_momentum - before.linear_momentum).norm(), 1e-12 * size) << count;
      // About the origin, from which the body has flown far: in terms of what it carries now.
      const double arm = solver.state().particles.position(0).norm();
      EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(), 1e-12 * size * arm) << count;
    }
}

}  // namespace
}  // namespace deforma
