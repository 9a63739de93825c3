#include "tests/hard/bodies.hpp"

namespace deforma {
namespace {

using namespace hard;

TEST(HardCaseSlow, Row10StiffnessAndDensityOverManyDecades) {
  struct Case {
    double young, density;
  };
  const Case cases[] = {{1e-3, 1000}, {1e12, 1000}, {1e6, 1e-3},  {1e6, 1e5},
                        {1e-3, 1e-3}, {1e-3, 1e5},  {1e12, 1e-3}, {1e12, 1e5}};
  for (Gradient gradient : both_fits)
    for (const Case& c : cases) {
      SCOPED_TRACE(testing::Message()
                   << gradient_name(gradient) << ", E " << c.young << " Pa, rho " << c.density);
      State state = cube_particles(0.0, c.density);
      prepare(state, gradient);
      stir(state, 0.01 * wave_speed(c.young, poisson, c.density), 6 * spacing);
      Solver solver = make_solver(std::move(state), elastic(gradient, 0, c.young));
      const double drift = energy_drift(solver, 10000);
      EXPECT_TRUE(finite_everywhere(solver.state()));
      EXPECT_LT(drift, 0.01);
    }
}

struct Pulled {
  double step;           // first stable one [s]
  double volume_change;  // the largest of all times, relative
};

// The cube, suddenly pulled apart at two opposite faces.
Pulled pull(double nu, Gradient gradient) {
  State state = cube(gradient);
  auto requests = elastic(gradient, 0, young, nu);
  for (double side : {0.0, 1.0}) {
    Region face;
    face.min.z() = face.max.z() = side * 6 * spacing;
    requests.push_back(
        {"load",
         {0, given("load", {{"traction", Curve<Vec3>(Vec3(0, 0, (2 * side - 1) * 0.01 * young))},
                            {"region", face}})}});
  }
  Solver solver = make_solver(std::move(state), requests);
  Pulled pulled{solver.stable_step(), 0.0};
  std::vector<Vec3> points(solver.state().surface.size());
  const auto volume = [&] {
    solver.deform(points);
    double sum = 0.0;
    for (const Triangle& t : solver.state().surface.triangles)
      sum += points[t[0]].dot(points[t[1]].cross(points[t[2]])) / 6.0;
    return sum;
  };
  const double before = volume(), period = 2 * 6 * spacing / std::sqrt(young / density);
  for (int k = 0; k < 100; ++k) {
    solver.advance(0.02 * period);
    pulled.volume_change = std::max(pulled.volume_change, std::abs(volume() / before - 1.0));
  }
  take_steps(solver, 10000);
  EXPECT_TRUE(finite_everywhere(solver.state()));
  EXPECT_LT(largest_norm(solver.state().particles.displacement), spacing) << "stable";
  return pulled;
}

TEST(HardCaseSlow, Row11PoissonsRatioUpToNearlyOneHalf) {
  for (Gradient gradient : both_fits) {
    const Pulled usual = pull(poisson, gradient);
    EXPECT_GT(usual.volume_change, 1e-4);
    for (double nu : {0.0, 0.45, 0.49, 0.499, 0.4999}) {
      SCOPED_TRACE(testing::Message() << gradient_name(gradient) << ", nu " << nu);
      const Pulled other = pull(nu, gradient);
      const double expected = usual.step * wave_speed() / wave_speed(young, nu);
      // Where shear and hourglass control have a share in the limit, it is a little less than 1/c.
      EXPECT_GT(other.step, 0.7 * expected);
      EXPECT_LT(other.step, 1.3 * expected);
      // Below 0.3 the exact answer itself changes its volume more: by (1 - 2 nu) p / E.
      if (nu > poisson) {
        EXPECT_LE(other.volume_change, usual.volume_change);
      }
    }
  }
}

}  // namespace
}  // namespace deforma
