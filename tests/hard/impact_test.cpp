#include "tests/hard/bodies.hpp"

namespace deforma {
namespace {

using namespace hard;

EffectRequest contact(double friction = 0.3, double restitution = 0.3) {
  return {"contact",
          {0, given("contact",
                    {{"friction", Curve<double>(friction)}, {"restitution", Curve<double>(restitution)}})}};
}

TEST(HardCase, Row17ImpactOnAWall) {
  for (Gradient gradient : both_fits)
    for (Integrator integrator : {Integrator::velocity_verlet, Integrator::symplectic_euler})
      for (double speed : {0.1, 0.5, 1.0, 2.0}) {
        SCOPED_TRACE(testing::Message() << gradient_name(gradient) << ", "
                                        << (integrator == Integrator::velocity_verlet ? "Verlet" : "Euler")
                                        << ", speed " << speed << " c");
        State state = cube_particles();
        Obstacle wall{.name = "wall", .shape = PlaneShape{}};
        wall.position = Vec3(0, 0, -0.5 * spacing);
        state.obstacles.push_back(wall);
        prepare(state, gradient);
        for (Vec3& v : state.particles.velocity) v.z() = -speed * wave_speed();
        Solver solver =
            make_solver(std::move(state), elastic(gradient) + contact(), {.integrator = integrator});
        const double before = solver.ledger().total(), end = 40 * 0.5 * spacing / (speed * wave_speed());
        std::vector<Vec3> points(solver.state().surface.size());
        double deepest = 0.0, most = 0.0;
        while (solver.state().time < end) {
          take_steps(solver, 5);
          solver.deform(points);
          for (const Vec3& point : points) deepest = std::max(deepest, -0.5 * spacing - point.z());
          for (std::size_t i = 0; i < solver.state().size(); ++i)
            deepest = std::max(deepest, -0.5 * spacing - solver.state().particles.position(i).z());
          most = std::max(most, solver.ledger().total() / before);
          ASSERT_TRUE(finite_everywhere(solver.state()));
        }
        EXPECT_LT(deepest, 0.5 * spacing);
        // Symplectic Euler is of first order where its step changes: from 1 c on it gains some per cent.
        if (integrator == Integrator::velocity_verlet) {
          EXPECT_LT(most, 1.01);
        }
      }
}

TEST(HardCaseSlow, Row18FastTowardsAWall) {
  std::mt19937 generator(6);
  for (Gradient gradient : both_fits)
    for (int side : {1, 3})  // one particle, a sheet
      for (int k = 0; k < 1000; ++k) {
        const Vec3 normal = random_direction(generator);
        Vec3 direction = random_direction(generator);
        if (normal.dot(direction) > 0.0) direction = -direction;
        State state =
            lattice_particles(Vec3(side * spacing, side * spacing, spacing), side, side, 1, density);
        pose_rest(state, random_rotation(generator));
        double reach = 0.0;
        for (const Vec3& X : state.surface.rest) reach = std::max(reach, X.norm());
        Obstacle wall{.name = "wall", .shape = PlaneShape{normal}};
        wall.position = Vec3(-(reach + spacing) * normal);
        state.obstacles.push_back(wall);
        prepare(state, gradient);
        // Without contact: 12 spacings a step. One particle alone has no step of its own.
        const double dt =
            side == 1 ? spacing / wave_speed() : make_solver(state, elastic(gradient)).stable_step();
        const double speed = 12 * spacing / dt;
        // Grazing, it would never get there: at least a tenth of the speed is towards the wall.
        direction = (direction - (0.1 + normal.dot(direction)) * normal * (normal.dot(direction) > -0.1))
                        .normalized();
        for (Vec3& v : state.particles.velocity) v = speed * direction;
        Solver solver = make_solver(std::move(state), elastic(gradient) + contact(), {.max_step = dt});
        for (int step = 0; step < 12; ++step) {
          solver.advance(dt);
          // While an impact at more than ten times the wave speed lasts the spring yields, by far less than what a
          // particle unseen would fly on; in the end all are on the right side.
          const double yielding = step == 11 ? 0.0 : 2.0 * spacing;
          for (std::size_t i = 0; i < solver.state().size(); ++i)
            ASSERT_GT(normal.dot(solver.state().particles.position(i) - wall.position.at(0.0)), -yielding)
                << gradient_name(gradient) << ", " << side << ", direction " << k << ", step " << step;
        }
        ASSERT_TRUE(finite_everywhere(solver.state()));
      }
}

}  // namespace
}  // namespace deforma
