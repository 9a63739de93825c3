#include <gmock/gmock.h>

#include "tests/hard/bodies.hpp"

namespace deforma {
namespace {

using namespace hard;

TEST(HardCase, Row16StepForcedToTenTimesTheLimit) {
  for (Gradient gradient : both_fits)
    for (Integrator integrator : {Integrator::symplectic_euler, Integrator::velocity_verlet}) {
      SCOPED_TRACE(gradient_name(gradient));
      State state = cube(gradient);
      agitate(state, 0.02 * wave_speed());
      Solver measured =
          make_solver(state, elastic(gradient), {.integrator = integrator, .step_fraction = 1.0});
      const double limit = measured.stable_step();
      // The asked step is only an upper bound: what is too long is divided.
      Solver solver =
          make_solver(state, elastic(gradient), {.integrator = integrator, .max_step = 10 * limit});
      const double before = solver.ledger().total();
      for (int step = 0; step < 200; ++step) {
        solver.advance(10 * limit);
        ASSERT_TRUE(finite_everywhere(solver.state()));
        ASSERT_LT(std::abs(solver.ledger().total()), 10 * before);
      }
      EXPECT_GE(solver.statistics().substeps, 2000u);
      EXPECT_LE(solver.statistics().largest_step, limit);
    }
}

// Ties every particle to its place, and claims to allow steps `claim` times as long as it does.
class Overconfident : public Effect {
 public:
  Overconfident(double stiffness, double claim) : stiffness_(stiffness), claim_(claim) {}

  std::string_view name() const override { return "overconfident"; }
  void force(const State& state, std::span<Vec3> force) override {
    for (std::size_t i = 0; i < state.size(); ++i) force[i] -= stiffness_ * state.particles.displacement[i];
  }
  double energy(const State& state) const override {
    double sum = 0.0;
    for (const Vec3& u : state.particles.displacement) sum += 0.5 * stiffness_ * u.squaredNorm();
    return sum;
  }
  double stable_step(const State& state) const override {
    return claim_ * 2.0 / std::sqrt(stiffness_ / state.particles.mass[0]);
  }

 private:
  double stiffness_, claim_;
};

TEST(HardCase, Row16RunThatGainsEnergyIsStopped) {
  for (Gradient gradient : both_fits)
    for (Integrator integrator : {Integrator::symplectic_euler, Integrator::velocity_verlet})
      for (double claim : {10.0, 2.0, 1.5}) {
        SCOPED_TRACE(testing::Message() << gradient_name(gradient) << ", claim " << claim);
        State state = cube(gradient);
        agitate(state, 1e-3 * wave_speed());
        auto effects = make_effects(state, elastic(gradient));
        effects.push_back(std::make_unique<Overconfident>(1e9, claim));
        Solver solver(std::move(state), std::move(effects), {.integrator = integrator});
        const double before = solver.ledger().total();
        int since_it_went_wrong = 0;
        std::string message;
        while (message.empty() && since_it_went_wrong <= 100) {
          try {
            solver.advance(solver.stable_step());
          } catch (const SimulationDiverged& error) {
            message = error.what();
          }
          if (since_it_went_wrong > 0 || !(std::abs(solver.ledger().total()) <= 10.0 * before))
            ++since_it_went_wrong;
          ASSERT_LT(solver.statistics().substeps, 20000u);
        }
        EXPECT_LE(since_it_went_wrong, 100);
        for (const char* part : {"t = ", "body 'box'", "particle ", "step_fraction"})
          EXPECT_THAT(message, testing::HasSubstr(part));
      }
}

TEST(HardCase, Row35PropertyJumpsDuringTheRun) {
  for (Gradient gradient : both_fits)
    for (double factor : {10.0, 0.1}) {
      SCOPED_TRACE(testing::Message() << gradient_name(gradient) << ", times " << factor);
      State state = cube(gradient, 0.2);
      const std::vector<Index> start = state.links.start;
      auto requests = elastic(gradient);
      requests[0].table.parameters.set("young",
                                       Curve<double>(std::vector<Curve<double>::Key>{
                                           {0.0, young}, {0.1, young}, {0.1 + 1e-9, factor * young}}));
      agitate(state, 0.02 * wave_speed());
      Solver solver = make_solver(std::move(state), requests);
      solver.advance(0.1);
      const double step_before = solver.stable_step();
      solver.advance(0.1);
      EXPECT_TRUE(finite_everywhere(solver.state()));
      EXPECT_NEAR(solver.stable_step(), step_before / std::sqrt(factor),
                  0.05 * step_before / std::sqrt(factor));
      EXPECT_EQ(solver.state().links.start, start) << "links are those of the reference configuration";
      // The rest shape still is one: nothing acts there.
      std::vector<Vec3> force(solver.state().size());
      solver.static_force(std::vector<Vec3>(solver.state().size(), Vec3::Zero()), force);
      EXPECT_EQ(largest_norm(force), 0.0);
      // And what was moving still moves about it.
      EXPECT_LT(deviation_from_rigid(solver.state()), spacing);
      solver.advance(0.5);
      EXPECT_TRUE(finite_everywhere(solver.state()));
    }
}

}  // namespace
}  // namespace deforma
