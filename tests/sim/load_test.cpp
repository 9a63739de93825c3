#include "sim/effects/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "fixtures.hpp"
#include "gradient_check.hpp"

namespace deforma {
namespace {

using Values = std::vector<std::pair<std::string_view, SettingValue>>;

State bar() { return lattice_box(Vec3(0.8, 0.3, 0.2), 8, 3, 2, 1000.0, 0.2); }
const Region right_end{.min = Vec3(0.799, -1, -1)};

std::vector<std::unique_ptr<Effect>> loads(State& state, std::vector<Values> tables) {
  std::vector<EffectRequest> requests;
  for (Values& values : tables) requests.push_back({"load", {0, given("load", std::move(values))}});
  return make_effects(state, requests);
}

Vec3 sum_of(const std::vector<Vec3>& force) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : force) sum += f;
  return sum;
}

TEST(Load, GivesTheForceInTotal) {
  State state = bar();
  auto effects = loads(state, {{{"force", Curve<Vec3>(Vec3(3, -4, 5))}, {"region", right_end}}});
  std::vector<Vec3> force = total_force(state, effects);
  EXPECT_LT((sum_of(force) - Vec3(3, -4, 5)).norm(), 1e-12);
  Vec3 torque = Vec3::Zero(), expected = Vec3::Zero();
  double area = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) torque += state.particles.rest[i].cross(force[i]);
  for (Index s : state.surface.active) {
    expected += state.surface.rest[s].cross(state.surface.area[s] * Vec3(3, -4, 5));
    area += state.surface.area[s];
  }
  EXPECT_LT((torque - expected / area).norm(), 1e-11);
}

TEST(Load, GivesTractionTimesArea) {
  State state = bar();
  auto effects = loads(state, {{{"traction", Curve<Vec3>(Vec3(100, 0, 0))}, {"region", right_end}}});
  // The region also holds the side faces' last row of vertices, each with its part of their area.
  double area = 0.0;
  for (std::size_t s = 0; s < state.surface.size(); ++s)
    if (right_end.contains(state.surface.rest[s])) area += state.surface.area[s];
  EXPECT_GE(area, 0.06);
  EXPECT_NEAR(sum_of(total_force(state, effects)).x(), 100.0 * area, 1e-10);
}

TEST(Load, TheForceIsTheGradientOfTheEnergy) {
  State state = bar();
  scramble(state, 0.02);
  auto effects = loads(state, {{{"force", Curve<Vec3>(Vec3(3, -4, 5))}, {"region", right_end}},
                               {{"traction", Curve<Vec3>(Vec3(10, 20, -5))}}});
  EXPECT_LT(gradient_error(state, effects, 1e-3), 1e-6);
}

TEST(Load, FollowsItsKeyframes) {
  State state = bar();
  Curve<Vec3> ramp(std::vector<Curve<Vec3>::Key>{{0.0, Vec3(0, 0, 0)}, {2.0, Vec3(0, 0, -8)}});
  auto effects = loads(state, {{{"force", ramp}}});
  state.time = 0.5;
  EXPECT_LT((sum_of(total_force(state, effects)) - Vec3(0, 0, -2)).norm(), 1e-12);
}

TEST(Load, RefusesWhatLoadsNothing) {
  State state = bar();
  auto message = [&](Values values) -> std::string {
    try {
      loads(state, {std::move(values)});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  Region away{.min = Vec3(5, 5, 5)};
  EXPECT_THAT(message({{"force", Curve<Vec3>(Vec3(1, 0, 0))}, {"region", away}}),
              testing::HasSubstr("the region of a load on body 'box' holds none of its"));
  EXPECT_THAT(message({{"region", right_end}}), testing::HasSubstr("needs a force [N] or a traction [Pa]"));
}

}  // namespace
}  // namespace deforma
