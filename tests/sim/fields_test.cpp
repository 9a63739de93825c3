#include "sim/fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fixtures.hpp"
#include "gradient_check.hpp"

namespace deforma {
namespace {

using Effects = std::vector<std::unique_ptr<Effect>>;

constexpr double young = 2e5, poisson = 0.3;

State bar(Gradient gradient = Gradient::linear) {
  return lattice_box(Vec3(1.0, 0.4, 0.4), 10, 4, 4, 1000.0, 0.2, {}, gradient);
}

EffectRequest elastic(const std::string& material) {
  return {"elastic",
          {0, given("elastic", {{"young", Curve<double>(young)},
                                {"poisson", Curve<double>(poisson)},
                                {"material", material}})}};
}

void deform(State& state, const Mat3& A) {
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.displacement[i] = A * state.particles.rest[i] - state.particles.rest[i];
}

struct Values {
  std::vector<float> particles, vertices;
};

Values values_of(std::string_view field, const State& state, const Effects& effects) {
  Values values{std::vector<float>(state.size(), -1.0f), std::vector<float>(state.surface.size(), -1.0f)};
  evaluate_field(find_field(field), state, effects, values.particles, values.vertices);
  return values;
}

void expect_everywhere(const Values& values, double expected, double tolerance) {
  for (float value : values.particles) EXPECT_NEAR(value, expected, tolerance);
  for (float value : values.vertices) EXPECT_NEAR(value, expected, tolerance);
}

TEST(Fields, AUniaxiallyStretchedBarHasTheKnownStressAtEveryVertex) {
  // St.Venant-Kirchhoff with lateral Green strain -nu e: S = young e along the bar and zero across it; Cauchy F S F^T / J.
  const double e = 0.15, a = std::sqrt(1.0 + 2.0 * e), b = std::sqrt(1.0 - 2.0 * poisson * e);
  for (Gradient gradient : {Gradient::linear, Gradient::quadratic}) {
    State state = bar(gradient);
    const std::vector<EffectRequest> requests = {elastic("st_venant_kirchhoff"),
                                                 {"hourglass", {0, given("hourglass")}}};
    const Effects effects = make_effects(state, requests);
    // Turned as well: no component of the stress alone is the answer.
    const Mat3 R = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    deform(state, R * Vec3(a, b, b).asDiagonal());
    const double stress = young * e * a / (b * b);
    expect_everywhere(values_of("von_mises", state, effects), stress, 1e-5 * stress);
    expect_everywhere(values_of("principal_stretch", state, effects), a, 1e-6);
    expect_everywhere(values_of("det_f", state, effects), a * b * b, 1e-6);
    expect_everywhere(values_of("energy_density", state, effects), 0.5 * young * e * e, 1e-5 * young * e * e);
  }
}

TEST(Fields, NeoHookeanShearHasTheKnownStress) {
  // Simple shear g keeps the volume: Cauchy = mu F F^T + p I; von Mises = mu sqrt(g^4 + 3 g^2).
  State state = bar();
  const std::vector<EffectRequest> requests = {elastic("neo_hookean")};
  const Effects effects = make_effects(state, requests);
  const double g = 0.4, mu = young / (2.0 * (1.0 + poisson));
  Mat3 F = Mat3::Identity();
  F(0, 1) = g;
  deform(state, F);
  const double stress = mu * std::sqrt(g * g * g * g + 3.0 * g * g);
  expect_everywhere(values_of("von_mises", state, effects), stress, 1e-5 * stress);
  expect_everywhere(values_of("det_f", state, effects), 1.0, 1e-6);
}

TEST(Fields, RigidMotionHasNoStrainButItsDisplacementAndSpeed) {
  State state = bar(Gradient::quadratic);
  const std::vector<EffectRequest> requests = {
      elastic("neo_hookean"), {"volume", {0, given("volume", {{"stiffness", Curve<double>(3e5)}})}}};
  const Effects effects = make_effects(state, requests);
  const Mat3 R = Eigen::AngleAxisd(2.0, Vec3(1, -1, 0.5).normalized()).toRotationMatrix();
  const Vec3 spin(3, -1, 2);
  deform(state, R);
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.velocity[i] = spin.cross(state.particles.position(i));
  expect_everywhere(values_of("von_mises", state, effects), 0.0, 1e-8 * young);
  expect_everywhere(values_of("energy_density", state, effects), 0.0, 1e-8 * young);
  expect_everywhere(values_of("principal_stretch", state, effects), 1.0, 1e-6);
  expect_everywhere(values_of("det_f", state, effects), 1.0, 1e-6);
  const Values displacement = values_of("displacement", state, effects),
               speed = values_of("speed", state, effects);
  for (std::size_t i = 0; i < state.size(); ++i) {
    EXPECT_NEAR(displacement.particles[i], state.particles.displacement[i].norm(), 1e-6);
    EXPECT_NEAR(speed.particles[i], state.particles.velocity[i].norm(), 1e-6);
  }
  for (std::size_t s = 0; s < state.surface.size(); ++s) {
    const Vec3 X = state.surface.rest[s];
    EXPECT_NEAR(displacement.vertices[s], (R * X - X).norm(), 1e-6);
    EXPECT_NEAR(speed.vertices[s], spin.cross(R * X).norm(), 1e-5);
  }
}

TEST(Fields, ViscousStressCounts) {
  // At F = I a rate of shear r gives the stress viscosity times its symmetric part: von Mises sqrt(3) viscosity r / 2.
  State state = bar();
  const std::vector<EffectRequest> requests = {
      {"damping", {0, given("damping", {{"viscosity", Curve<double>(40.0)}})}}};
  const Effects effects = make_effects(state, requests);
  Mat3 rate = Mat3::Zero();
  rate(0, 2) = 1.5;
  state.F_rate.assign(state.size(), rate);
  const double stress = std::sqrt(3.0) * 40.0 * 1.5 / 2.0;
  expect_everywhere(values_of("von_mises", state, effects), stress, 1e-5 * stress);
}

TEST(Fields, EnergyDensityIsWhatTheEffectsEnergyAddsUpFrom) {
  State state = bar(Gradient::quadratic);
  const std::vector<EffectRequest> requests = {
      elastic("corotated"), {"volume", {0, given("volume", {{"stiffness", Curve<double>(3e5)}})}}};
  const Effects effects = make_effects(state, requests);
  scramble(state, 0.02);
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  const Values density = values_of("energy_density", state, effects);
  double sum = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i) sum += state.fit.weight[i] * density.particles[i];
  const double energy = effects[0]->energy(state) + effects[1]->energy(state);
  EXPECT_GT(energy, 0.0);
  EXPECT_NEAR(sum, energy, 1e-5 * energy);
}

TEST(Fields, ASheetHasTheRatioOfItsAreas) {
  State state = lattice_box(Vec3(1.0, 1.0, 0.1), 10, 10, 1, 1000.0);
  const std::vector<EffectRequest> requests = {elastic("neo_hookean")};
  const Effects effects = make_effects(state, requests);
  ASSERT_EQ(state.fit.rank[50], 2);
  deform(state, Vec3(1.2, 0.9, 1.0).asDiagonal());
  expect_everywhere(values_of("det_f", state, effects), 1.08, 1e-6);
  expect_everywhere(values_of("principal_stretch", state, effects), 1.2, 1e-6);
}

TEST(Fields, OnlyWhatIsAskedForIsWritten) {
  State state = bar();
  const std::vector<EffectRequest> requests = {elastic("neo_hookean")};
  const Effects effects = make_effects(state, requests);
  deform(state, Vec3(1.1, 1.0, 1.0).asDiagonal());
  std::vector<float> vertices(state.surface.size());
  for (const FieldInfo& field : field_registry()) {
    evaluate_field(field, state, effects, {}, vertices);
    EXPECT_EQ(vertices, values_of(field.name, state, effects).vertices) << field.name;
  }
}

TEST(Fields, RefusesUnknownNamesAndWrongLengths) {
  State state = bar();
  EXPECT_THAT([] { find_field("stress"); },
              testing::ThrowsMessage<std::invalid_argument>(testing::AllOf(
                  testing::HasSubstr("unknown field 'stress'"), testing::HasSubstr("von_mises"))));
  std::vector<float> three(3);
  EXPECT_THAT([&] { evaluate_field(find_field("speed"), state, {}, three, {}); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("room for 3 and 0 values")));
}

}  // namespace
}  // namespace deforma
