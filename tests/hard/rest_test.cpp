#include "tests/hard/bodies.hpp"

namespace deforma {
namespace {

using namespace hard;

TEST(HardCaseSlow, Row22RestingInACylinder) {
  const double g = 9.81;
  for (Gradient gradient : both_fits) {
    SCOPED_TRACE(gradient_name(gradient));
    State state = lattice_particles(Vec3::Constant(3 * spacing), 3, 3, 3, density);
    pose_rest(state, Eigen::AngleAxisd(0.2, Vec3(1, 0.3, 0)).toRotationMatrix(), Vec3(-0.1, -0.15, 0.3));
    Obstacle glass{.name = "glass", .shape = CylinderShape{0.3, 1.0, true, true}, .friction = 0.3};
    glass.position = Vec3(0, 0, 0.5);
    state.obstacles.push_back(glass);
    prepare(state, gradient);
    const double mass = state.particles.mass[0];
    auto requests = elastic(gradient) + damping(5.0) + gravity(Vec3(0, 0, -g));
    requests.push_back({"contact", {0, given("contact")}});
    Solver solver = make_solver(std::move(state), requests);
    take_steps(solver, 100000);
    const std::vector<Vec3> then = solver.state().particles.displacement;
    double fastest = 0.0;
    for (int k = 0; k < 90; ++k) {
      take_steps(solver, 10000);
      fastest = std::max(fastest, largest_norm(solver.state().particles.velocity));
    }
    EXPECT_EQ(solver.statistics().substeps, 1000000u);
    EXPECT_TRUE(finite_everywhere(solver.state()));
    EXPECT_LT(0.5 * mass * fastest * fastest, 1e-6 * mass * g * spacing) << "of every particle";
    double creep = 0.0, lowest = 1.0;
    for (std::size_t i = 0; i < solver.state().size(); ++i) {
      creep = std::max(creep, (solver.state().particles.displacement[i] - then[i]).norm());
      lowest = std::min(lowest, solver.state().particles.position(i).z());
    }
    EXPECT_LT(creep, 0.01 * spacing);
    EXPECT_LT(lowest, 0.7 * spacing) << "it lies on the bottom";
    EXPECT_GT(lowest, 0.0);
  }
}

TEST(HardCaseSlow, Row23AtRestWithoutGravity) {
  for (Gradient gradient : both_fits) {
    Solver solver = make_solver(cube(gradient), elastic(gradient));
    take_steps(solver, 1000000);
    EXPECT_EQ(solver.statistics().substeps, 1000000u);
    EXPECT_EQ(largest_norm(solver.state().particles.displacement), 0.0);
    EXPECT_EQ(largest_norm(solver.state().particles.velocity), 0.0);
  }
}

TEST(HardCaseSlow, Row24FreeRotation) {
  for (Gradient gradient : both_fits) {
    SCOPED_TRACE(gradient_name(gradient));
    State state = cube(gradient);
    const Vec3 middle = Vec3::Constant(3 * spacing), spin(3.0, 20.0, 10.0);
    double size = 0.0;
    for (std::size_t i = 0; i < state.size(); ++i) {
      state.particles.velocity[i] = spin.cross(state.particles.rest[i] - middle) + Vec3(0.05, -0.02, 0.03);
      size += state.particles.mass[i] * state.particles.velocity[i].norm();
    }
    Solver solver = make_solver(std::move(state), elastic(gradient));
    const Ledger before = solver.ledger();
    double drift[2] = {0.0, 0.0};  // in each half of the run
    for (int k = 0; k < 200; ++k) {
      take_steps(solver, 500);
      drift[k / 100] =
          std::max(drift[k / 100], std::abs(solver.ledger().total() - before.total()) / before.total());
    }
    const Ledger after = solver.ledger();
    EXPECT_LT((after.linear_momentum - before.linear_momentum).norm(), 1e-12 * size);
    EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(),
              1e-9 * before.angular_momentum.norm());
    EXPECT_LT(std::max(drift[0], drift[1]), 1e-3);
    EXPECT_LT(drift[1], 2.0 * drift[0]) << "bounded";
    EXPECT_TRUE(finite_everywhere(solver.state()));
  }
}

}  // namespace
}  // namespace deforma
