#include "sim/inner_loops.hpp"

#include <gtest/gtest.h>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/divergence.hpp"
#include "sim/material.hpp"
#include "sim/step_control.hpp"

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

class InnerLoopsOf : public testing::TestWithParam<Gradient> {};

TEST_P(InnerLoopsOf, EveryInstructionSetAgreesToRounding) {
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

TEST_P(InnerLoopsOf, PortableInstructionsGiveTheSameBits) {
  if (!supports(Instructions::avx2)) GTEST_SKIP() << "this processor has one set of them";
  State state = irregular_world(GetParam());
  const Answer baseline = answer_of(state, Instructions::baseline, true);
  const Answer avx2 = answer_of(state, Instructions::avx2, true);
  EXPECT_EQ(baseline.F, avx2.F);
  EXPECT_EQ(baseline.force, avx2.force);
  const Lame lame = lame_constants(1e5, 0.3);
  std::vector<Mat3> P[2];
  StrainSurvey survey[2];
  for (int k = 0; k < 2; ++k) {
    const InnerLoops& loops = inner_loops_of(k ? Instructions::avx2 : Instructions::baseline);
    P[k].assign(state.size(), Mat3::Zero());
    add_first_piola_kirchhoff(Material::neo_hookean, lame, baseline.F, P[k], loops);
    survey[k].look(baseline.F, P[k], loops);
  }
  EXPECT_EQ(P[0], P[1]);
  EXPECT_EQ(survey[0].stiffening, survey[1].stiffening);
  EXPECT_EQ(survey[0].change, survey[1].change);
}

INSTANTIATE_TEST_SUITE_P(Gradients, InnerLoopsOf, testing::Values(Gradient::linear, Gradient::quadratic),
                         [](const auto& info) { return std::string(gradient_name(info.param)); });

// Strain is worked on by fours: every number of them left over.
class StrainLoops : public testing::TestWithParam<Instructions> {
 protected:
  void SetUp() override {
    if (!supports(GetParam())) GTEST_SKIP() << "this processor does not have them";
  }
  const InnerLoops& loops() const { return inner_loops_of(GetParam()); }

  static std::vector<Mat3> some_strain(std::size_t count, double far) {
    std::vector<Mat3> F(count);
    for (std::size_t k = 0; k < count; ++k)
      F[k] = Mat3::Identity() + far * Mat3::NullaryExpr([&](Eigen::Index r, Eigen::Index c) {
                                  return std::sin(1.0 + 7.0 * static_cast<double>(k) +
                                                  3.0 * static_cast<double>(r) + static_cast<double>(c));
                                });
    return F;
  }
};

TEST_P(StrainLoops, AddTheStressThatTheFormulaGives) {
  const Lame lame = lame_constants(1e5, 0.3);
  for (std::size_t count : {1, 2, 3, 4, 5, 8, 11}) {
    const std::vector<Mat3> F = some_strain(count, 0.6);
    std::vector<Mat3> P(count + 1, Mat3::Constant(7.0));
    loops().neo_hookean(lame.lambda, lame.mu, F.data()->data(), count, P.data()->data());
    for (std::size_t k = 0; k < count; ++k)
      EXPECT_LT(
          (P[k] - Mat3::Constant(7.0) - first_piola_kirchhoff(Material::neo_hookean, lame, F[k])).norm(),
          1e-15 * 30.0 * lame.p_wave_modulus());
    EXPECT_EQ(P.back(), Mat3::Constant(7.0)) << "written past the end";
  }
}

TEST_P(StrainLoops, SurveyTheLargest) {
  for (std::size_t count : {1, 2, 3, 4, 5, 8, 11}) {
    const std::vector<Mat3> F = some_strain(count, 0.6), before = some_strain(count, 0.5);
    StrainSurvey survey;
    survey.look(F, before, loops());
    double stiffening = 0.0, change = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      stiffening = std::max(stiffening, 0.5 + F[k].squaredNorm() + cofactor(F[k]).squaredNorm() +
                                            std::abs(F[k].determinant() - 1.0) * F[k].norm());
      change = std::max(change, (F[k] - before[k]).squaredNorm() / std::max(1.0, F[k].squaredNorm()));
    }
    EXPECT_NEAR(survey.stiffening, stiffening, 1e-13 * stiffening);
    EXPECT_NEAR(survey.change, change, 1e-13 * change);
  }
}

TEST_P(StrainLoops, SurveyFindsWhatIsNoDeformation) {
  for (double wrong : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, exploded})
    for (std::size_t where = 0; where < 7; ++where)
      for (int entry : {0, 4, 8}) {
        std::vector<Mat3> F(7, Mat3::Identity());
        F[where].data()[entry] = wrong;
        StrainSurvey survey;
        survey.look(F, std::vector<Mat3>(7, Mat3::Identity()), loops());
        EXPECT_EQ(survey.stiffening, std::numeric_limits<double>::infinity()) << wrong << " in " << where;
        EXPECT_EQ(survey.change, 0.0);
      }
}

INSTANTIATE_TEST_SUITE_P(Instructions, StrainLoops, testing::ValuesIn(all_instructions),
                         [](const auto& info) { return std::string(instructions_name(info.param)); });

TEST(InnerLoops, IsPortableWhereThatIsAskedFor) {
  State state = lattice_particles(Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  prepare_state(state, {});
  EXPECT_EQ(state.links.instructions, fastest_instructions());
  prepare_state(state, {.portable = true});
  EXPECT_EQ(state.links.instructions, portable_instructions());
  EXPECT_NE(portable_instructions(), Instructions::avx2_fma);
}

TEST(InnerLoops, RefusesWhatTheProcessorDoesNotHave) {
  for (Instructions instructions : all_instructions)
    if (!supports(instructions)) {
      EXPECT_THROW(inner_loops_of(instructions), std::invalid_argument);
    }
  EXPECT_NO_THROW(inner_loops_of(portable_instructions()));
}

}  // namespace
}  // namespace deforma
