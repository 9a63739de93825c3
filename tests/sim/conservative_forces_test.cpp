#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/material.hpp"

namespace deforma {
namespace {

// Every effect whose force is the gradient of an energy: all but damping, which has none, and pins, which prescribe
// motion. Contact is one with restitution 1 and without friction.
const std::set<std::string_view> without_energy = {"damping", "pin"};

// Two irregular bodies side by side, the upper one pressed a little into the lower one and a plane a little into both.
State two_bodies(Gradient gradient) {
  State state = lattice_particles(Vec3(0.4, 0.4, 0.3), 4, 4, 3, 1000.0, 0.3);
  append_body(state, lattice_particles(Vec3(0.42, 0.38, 0.32), 4, 4, 3, 700.0, 0.3), Vec3(0.03, 0.02, 0.297));
  Obstacle wall{.name = "wall", .shape = PlaneShape{Vec3(1, 0.1, 0.05)}};
  wall.position = Vec3(0.012, 0, 0);
  state.obstacles.push_back(wall);
  const NeighborhoodSettings settings = gradient == Gradient::linear
                                            ? NeighborhoodSettings{}
                                            : NeighborhoodSettings{.neighbors = 30, .support = 1.7};
  prepare_state(state, settings, {}, {}, gradient);
  scramble(state, 0.004);
  return state;
}

std::vector<EffectRequest> requests_for(std::string_view effect,
                                        const std::string& material = "neo_hookean") {
  std::vector<EffectRequest> requests;
  for (Index body : {0, 1}) {
    const auto add = [&](std::vector<std::pair<std::string_view, SettingValue>> values) {
      requests.push_back({effect, {body, given(effect, std::move(values))}});
    };
    if (effect == "elastic") add({{"young", Curve<double>(1e5)}, {"material", material}});
    if (effect == "hourglass") add({{"stiffness", Curve<double>(3.0)}});
    if (effect == "volume") add({{"stiffness", Curve<double>(2e5)}});
    if (effect == "contact") add({{"friction", Curve<double>(0.0)}, {"restitution", Curve<double>(1.0)}});
    if (effect == "pressure") add({{"value", Curve<double>(3e3)}});
    if (effect == "gravity") add({});
    if (effect == "lennard_jones") add({{"depth", Curve<double>(0.05)}, {"radius", Curve<double>(0.1)}});
    if (effect == "load") {
      Region top;
      top.min.z() = 0.29;
      add({{"traction", Curve<Vec3>(Vec3(500, -300, 1000))}, {"region", top}});
    }
  }
  return requests;
}

class ConservativeForces : public testing::TestWithParam<Gradient> {};

TEST_P(ConservativeForces, SupportRadiiDifferFromParticleToParticle) {
  const State state = two_bodies(GetParam());
  const auto [least, most] = std::minmax_element(state.links.support.begin(), state.links.support.end());
  EXPECT_GT(*most, 1.2 * *least);
}

TEST_P(ConservativeForces, EachAloneIsTheGradientOfItsEnergy) {
  std::set<std::string_view> checked;
  for (const EffectInfo& info : effect_registry()) {
    if (without_energy.contains(info.name)) continue;
    for (std::string_view material : material_names()) {
      if (info.name != "elastic" && material != material_names().front()) continue;
      State state = two_bodies(GetParam());
      std::vector<EffectRequest> requests = requests_for(info.name, std::string(material));
      ASSERT_FALSE(requests.empty()) << info.name << " has no case here";
      // Hourglass control and contact take their scale from the elastic table.
      if (info.name == "hourglass" || info.name == "contact")
        for (const EffectRequest& request : requests_for("elastic")) requests.push_back(request);
      auto effects = make_effects(state, requests);
      std::erase_if(effects, [&](const auto& effect) { return effect->name() != info.name; });
      ASSERT_EQ(effects.size(), 1u);
      const double step = info.name == "contact" ? 1e-7 : 1e-5;
      EXPECT_LT(gradient_error(state, effects, step), 1e-6) << info.name << " " << material;
      checked.insert(info.name);
    }
  }
  EXPECT_EQ(checked.size() + without_energy.size(), effect_registry().size());
}

TEST_P(ConservativeForces, AllTogetherAreTheGradientOfTheirEnergy) {
  for (std::string_view material : material_names()) {
    State state = two_bodies(GetParam());
    std::vector<EffectRequest> requests;
    for (const EffectInfo& info : effect_registry())
      for (const EffectRequest& request : requests_for(info.name, std::string(material)))
        requests.push_back(request);
    auto effects = make_effects(state, requests);
    EXPECT_EQ(effects.size() + without_energy.size(), effect_registry().size());
    EXPECT_LT(gradient_error(state, effects, 1e-6), 1e-6) << material;
    for (const auto& effect : effects) EXPECT_NE(effect->energy(state), 0.0) << effect->name();
  }
}

INSTANTIATE_TEST_SUITE_P(Both, ConservativeForces, testing::Values(Gradient::linear, Gradient::quadratic),
                         [](const auto& info) { return std::string(gradient_name(info.param)); });

}  // namespace
}  // namespace deforma
