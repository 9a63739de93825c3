#include "sim/material.hpp"
#include "tests/hard/bodies.hpp"

namespace deforma {
namespace {

using namespace hard;

constexpr double rate = 20.0;  // of the damping [1/s]; the slowest mode of the cube turns at about 160 rad/s

void reflect(State& state) {
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.displacement[i].z() = 6 * spacing - 2 * state.particles.rest[i].z();
}

double least_determinant(const State& state) {
  double least = 1e300;
  for (const Mat3& F : state.F) least = std::min(least, F.determinant());
  return least;
}

double largest_determinant(const State& state) {
  double largest = -1e300;
  for (const Mat3& F : state.F) largest = std::max(largest, F.determinant());
  return largest;
}

TEST(HardCase, Row13ReflectedStart) {
  for (Gradient gradient : both_fits) {
    SCOPED_TRACE(gradient_name(gradient));
    State state = cube(gradient);
    reflect(state);
    Solver solver = make_solver(std::move(state), elastic(gradient) + damping(rate));
    EXPECT_LT(largest_determinant(solver.state()), -0.9);
    solver.advance(2.0);
    EXPECT_TRUE(finite_everywhere(solver.state()));
    EXPECT_LT(deviation_from_rigid(solver.state()), 1e-3 * spacing);
    EXPECT_GT(least_determinant(solver.state()), 0.99);

    // St. Venant-Kirchhoff is blind to reflection.
    State blind = cube(gradient);
    reflect(blind);
    Solver alone = make_solver(std::move(blind),
                               elastic(gradient, 0, young, poisson, "st_venant_kirchhoff") + damping(rate));
    alone.advance(0.5);
    EXPECT_LT(largest_determinant(alone.state()), -0.9);
  }
}

TEST(HardCase, Row14SquashedFlat) {
  for (Gradient gradient : both_fits) {
    SCOPED_TRACE(gradient_name(gradient));
    State state = cube(gradient);
    for (std::size_t i = 0; i < state.size(); ++i)
      state.particles.displacement[i].z() = 3 * spacing - state.particles.rest[i].z();
    scramble(state, 1e-3 * spacing);
    Solver solver = make_solver(std::move(state), elastic(gradient) + damping(rate));
    solver.advance(2.0);
    EXPECT_TRUE(finite_everywhere(solver.state()));
    EXPECT_LT(deviation_from_rigid(solver.state()), 1e-3 * spacing);
  }
}

TEST(HardCaseSlow, Row15SquashedExactlyFlatOrToOnePoint) {
  for (Gradient gradient : both_fits)
    for (bool to_a_point : {false, true})
      for (std::string_view material : material_names()) {
        SCOPED_TRACE(testing::Message()
                     << gradient_name(gradient) << (to_a_point ? ", a point, " : ", flat, ") << material);
        State state = cube(gradient);
        for (std::size_t i = 0; i < state.size(); ++i) {
          const Vec3 to_middle = Vec3::Constant(3 * spacing) - state.particles.rest[i];
          state.particles.displacement[i] = to_a_point ? to_middle : Vec3(0, 0, to_middle.z());
        }
        Solver solver =
            make_solver(std::move(state), elastic(gradient, 0, young, poisson, std::string(material)));
        for (const Mat3& F : solver.state().F) {
          const Mat3 R = nearest_rotation(F);
          ASSERT_NEAR(F.determinant(), 0.0, 1e-12);
          ASSERT_NEAR(R.determinant(), 1.0, 1e-12);
          ASSERT_LT((R.transpose() * R - Mat3::Identity()).norm(), 1e-12);
        }
        take_steps(solver, material == "neo_hookean" ? 10000 : 1000);  // the default, and the others
        EXPECT_TRUE(finite_everywhere(solver.state()));
      }
}

}  // namespace
}  // namespace deforma
