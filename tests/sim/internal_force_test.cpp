#include "sim/internal_force.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/material.hpp"

namespace deforma {
namespace {

// An irregular body whose support radii differ from particle to particle.
State irregular_body(Kernel kernel = Kernel::cubic_spline) {
  return lattice_box(Vec3(0.4, 0.3, 0.3), 4, 3, 3, 1000.0, 0.3, {.kernel = kernel});
}

State quadratic_body() {
  return lattice_box(Vec3(0.5, 0.4, 0.4), 5, 4, 4, 1000.0, 0.2, {.neighbors = 30, .support = 1.7},
                     Gradient::quadratic);
}

std::vector<EffectRequest> request(std::string_view effect, const std::string& material = "neo_hookean") {
  EffectRequest elastic{"elastic",
                        {0, given("elastic", {{"young", Curve<double>(1e5)}, {"material", material}})}};
  if (effect == "elastic") return {elastic};
  if (effect == "hourglass") return {elastic, {"hourglass", {0, given("hourglass")}}};
  return {{effect, {0, given(effect, {{"stiffness", Curve<double>(2e5)}})}}};
}

TEST(InternalForce, IsTheGradientOfTheEnergyForEveryKernelAndMaterial) {
  for (int kernel = 1; kernel <= 5; ++kernel)
    for (std::string_view material : material_names()) {
      State state = irregular_body(static_cast<Kernel>(kernel));
      scramble(state, 0.02);
      auto effects = make_effects(state, request("elastic", std::string(material)));
      EXPECT_LT(gradient_error(state, effects, 1e-5), 1e-6) << kernel << " " << material;
    }
}

TEST(InternalForce, IsTheGradientOfHourglassControlAlone) {
  State state = irregular_body();
  scramble(state, 0.02);
  auto effects = make_effects(state, request("hourglass"));
  effects.erase(effects.begin());  // without the elastic one
  EXPECT_LT(gradient_error(state, effects, 1e-5), 1e-6);
}

TEST(InternalForce, IsTheGradientOfVolumeStiffnessAlone) {
  State state = irregular_body();
  scramble(state, 0.02);
  auto effects = make_effects(state, request("volume"));
  EXPECT_LT(gradient_error(state, effects, 1e-5), 1e-6);
}

TEST(InternalForce, IsTheGradientOfAllOfThemTogetherUnderLargeDeformation) {
  State state = irregular_body();
  scramble(state, 0.05);
  auto requests = request("hourglass");
  requests.push_back(request("volume").front());
  requests.push_back({"gravity", {0, given("gravity")}});
  auto effects = make_effects(state, requests);
  EXPECT_LT(gradient_error(state, effects, 1e-5), 1e-6);
}

TEST(InternalForce, IsTheGradientOfTheEnergyWithTheQuadraticFit) {
  State state = quadratic_body();
  scramble(state, 0.02);
  auto requests = request("hourglass");
  requests.push_back(request("volume").front());
  auto effects = make_effects(state, requests);
  EXPECT_LT(gradient_error(state, effects, 1e-5), 1e-6);
  std::swap(effects[0], effects[1]);
  effects.resize(1);  // hourglass control alone
  ASSERT_EQ(effects[0]->name(), "hourglass");
  EXPECT_LT(gradient_error(state, effects, 1e-5), 1e-6);
}

TEST(InternalForce, TheTrapezoidResidualIsBlindToQuadraticFields) {
  State state = quadratic_body();
  ASSERT_EQ(state.fit.linear_fits, 0u);
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3& X = state.particles.rest[i];
    state.particles.displacement[i] = 0.1 * Vec3(X.x() * X.x(), X.x() * X.y(), -X.z() * X.y());
  }
  auto effects = make_effects(state, request("hourglass"));
  double elastic = 0.0, hourglass = 0.0;
  refresh(state, effects);
  elastic = effects[0]->energy(state);
  hourglass = effects[1]->energy(state);
  EXPECT_GT(elastic, 0.0);
  EXPECT_LT(hourglass, 1e-20 * elastic);
}

TEST(InternalForce, KeepsMomentumForAnyStress) {
  for (State state : {irregular_body(), quadratic_body()}) {
    scramble(state, 0.05);
    std::vector<Mat3> P(state.size());
    std::vector<double> s(state.size());
    std::mt19937 generator(3);
    for (std::size_t i = 0; i < state.size(); ++i) {
      for (int e = 0; e < 9; ++e) P[i](e) = generator() / 4294967296.0 - 0.5;
      s[i] = generator() / 4294967296.0;
    }
    std::vector<Vec3> force(state.size(), Vec3::Zero());
    add_internal_force(state, P, s, force);
    Vec3 sum = Vec3::Zero();
    double size = 0.0;
    for (const Vec3& f : force) sum += f, size += f.norm();
    EXPECT_LT(sum.norm(), 1e-14 * size);
  }
}

TEST(InternalForce, GivesNoForceAndNoTorqueUnderRigidMotion) {
  for (std::string_view material : material_names()) {
    State state = irregular_body();
    Mat3 R = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    for (std::size_t i = 0; i < state.size(); ++i)
      state.particles.displacement[i] = R * state.particles.rest[i] + Vec3(5, 6, 7) - state.particles.rest[i];
    auto requests = request("hourglass", std::string(material));
    requests.push_back(request("volume").front());
    auto effects = make_effects(state, requests);
    for (const Vec3& f : total_force(state, effects)) EXPECT_LT(f.norm(), 1e-9 * 1e5 * 0.01) << material;
  }
}

TEST(InternalForce, GivesNoTorqueUnderAnyDeformation) {
  for (State state : {irregular_body(), quadratic_body()}) {
    scramble(state, 0.03);
    auto effects = make_effects(state, request("hourglass"));
    std::vector<Vec3> force = total_force(state, effects);
    Vec3 torque = Vec3::Zero();
    double size = 0.0;
    for (std::size_t i = 0; i < state.size(); ++i) {
      torque += state.particles.position(i).cross(force[i]);
      size += state.particles.position(i).norm() * force[i].norm();
    }
    EXPECT_LT(torque.norm(), 1e-13 * size);
  }
}

TEST(InternalForce, RefusesArraysOfDifferentLength) {
  State state = irregular_body();
  std::vector<Mat3> P(3);
  std::vector<Vec3> force(state.size());
  EXPECT_THROW(add_internal_force(state, P, {}, force), std::invalid_argument);
  P.resize(state.size());
  force.resize(3);
  EXPECT_THROW(add_internal_force(state, P, {}, force), std::invalid_argument);
}

}  // namespace
}  // namespace deforma
