#include "sim/gather.hpp"

#include <gtest/gtest.h>

#include "fixtures.hpp"
#include "gradient_check.hpp"

namespace deforma {
namespace {

constexpr Instructions all_instructions[] = {Instructions::baseline, Instructions::avx2,
                                             Instructions::avx2_fma};

// Rows of odd and even length, and empty ones: a body, a body of two particles and a lone one.
State irregular_world(Gradient gradient) {
  State state = lattice_particles(Vec3(0.7, 0.6, 0.5), 7, 6, 5, 1000.0, 0.3);
  append_body(state, lattice_particles(Vec3(0.2, 0.1, 0.1), 2, 1, 1, 1000.0), Vec3(2, 0, 0));
  append_body(state, lattice_particles(Vec3(0.1, 0.1, 0.1), 1, 1, 1, 1000.0), Vec3(3, 0, 0));
  prepare_state(state, {.neighbors = 22, .support = 1.6}, {}, {}, gradient);
  scramble(state, 0.02);
  return state;
}

struct Answer {
  std::vector<Mat3> F;
  std::vector<Vec3> force;
};

Answer answer_of(State& state, Instructions instructions, bool hourglass) {
  state.links.instructions = instructions;
  Answer answer{std::vector<Mat3>(state.size()), std::vector<Vec3>(state.size(), Vec3::Zero())};
  deformation_gradients(state.links, state.fit, state.particles.displacement, answer.F);
  state.F = answer.F;
  std::vector<double> s;
  if (hourglass) s.assign(state.size(), 0.7);
  add_internal_force(state, answer.F, s, answer.force);  // F stands for a stress
  return answer;
}

class GatherOf : public testing::TestWithParam<Gradient> {};

TEST_P(GatherOf, EveryInstructionSetAgreesToRounding) {
  State state = irregular_world(GetParam());
  for (bool hourglass : {false, true}) {
    const Answer reference = answer_of(state, Instructions::baseline, hourglass);
    double largest = 0.0;
    for (const Vec3& f : reference.force) largest = std::max(largest, f.norm());
    ASSERT_GT(largest, 0.0);
    for (Instructions instructions : all_instructions) {
      if (!supports(instructions)) continue;
      const Answer answer = answer_of(state, instructions, hourglass);
      for (std::size_t i = 0; i < state.size(); ++i) {
        EXPECT_LT((answer.F[i] - reference.F[i]).norm(), 1e-13) << instructions_name(instructions);
        EXPECT_LT((answer.force[i] - reference.force[i]).norm(), 1e-13 * largest)
            << instructions_name(instructions);
      }
    }
  }
}

TEST_P(GatherOf, PortableInstructionsGiveTheSameBits) {
  if (!supports(Instructions::avx2)) GTEST_SKIP() << "this processor has one set of them";
  State state = irregular_world(GetParam());
  const Answer baseline = answer_of(state, Instructions::baseline, true);
  const Answer avx2 = answer_of(state, Instructions::avx2, true);
  EXPECT_EQ(baseline.F, avx2.F);
  EXPECT_EQ(baseline.force, avx2.force);
}

INSTANTIATE_TEST_SUITE_P(Gradients, GatherOf, testing::Values(Gradient::linear, Gradient::quadratic),
                         [](const auto& info) { return std::string(gradient_name(info.param)); });

TEST(Gather, IsPortableWhereThatIsAskedFor) {
  State state = lattice_particles(Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  prepare_state(state, {});
  EXPECT_EQ(state.links.instructions, fastest_instructions());
  prepare_state(state, {.portable = true});
  EXPECT_EQ(state.links.instructions, portable_instructions());
  EXPECT_NE(portable_instructions(), Instructions::avx2_fma);
}

TEST(Gather, RefusesWhatTheProcessorDoesNotHave) {
  for (Instructions instructions : all_instructions)
    if (!supports(instructions)) {
      EXPECT_THROW(gather_with(instructions), std::invalid_argument);
    }
  EXPECT_NO_THROW(gather_with(portable_instructions()));
}

}  // namespace
}  // namespace deforma
