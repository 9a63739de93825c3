#include "sim/effects/pin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/solver.hpp"

namespace deforma {
namespace {

using Values = std::vector<std::pair<std::string_view, SettingValue>>;
using Key = Curve<Vec3>::Key;

const Region left{.max = Vec3(0.2, 1, 1)};
const Region right{.min = Vec3(0.6, -1, -1)};

Solver pinned_bar(std::vector<Values> pins) {
  State state = lattice_box(Vec3(0.8, 0.3, 0.3), 8, 3, 3, 1000.0);
  std::vector<EffectRequest> requests = {
      {"elastic", {0, given("elastic", {{"young", Curve<double>(1e5)}})}},
      {"hourglass", {0, given("hourglass")}},
      {"gravity", {0, given("gravity")}},
  };
  for (Values& values : pins) requests.push_back({"pin", {0, given("pin", std::move(values))}});
  auto effects = make_effects(state, requests);
  return Solver(std::move(state), std::move(effects), {});
}

TEST(Pin, HoldsExactly) {
  Solver solver = pinned_bar({{{"region", left}}});
  solver.advance(0.3);
  const Particles& p = solver.state().particles;
  double sagged = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    bool held = left.contains(p.rest[i]);
    EXPECT_EQ(solver.state().fixed[i] != 0, held);
    if (held) {
      EXPECT_EQ(p.displacement[i], Vec3(0, 0, 0));
      EXPECT_EQ(p.velocity[i], Vec3(0, 0, 0));
    } else {
      sagged = std::min(sagged, p.displacement[i].z());
    }
  }
  EXPECT_LT(sagged, -0.01);
}

TEST(Pin, FollowsItsKeyframesWithRotation) {
  Curve<Vec3> move(std::vector<Key>{{0.0, Vec3(0, 0, 0)}, {0.2, Vec3(0.1, 0, 0.04)}});
  Curve<Vec3> rotation(std::vector<Key>{{0.0, Vec3(0, 0, 0)}, {0.2, Vec3(90, 0, 0)}});
  const Vec3 center(0.7, 0.0, 0.1);
  Solver solver = pinned_bar(
      {{{"region", left}},
       {{"region", right}, {"move", move}, {"rotation", rotation}, {"center", Curve<Vec3>(center)}}});
  for (double time : {0.1, 0.2}) {
    solver.advance(0.1);
    const Particles& p = solver.state().particles;
    const Mat3 turn =
        Eigen::AngleAxisd(time / 0.2 * std::numbers::pi / 2.0, Vec3::UnitX()).toRotationMatrix();
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!right.contains(p.rest[i])) continue;
      Vec3 turned = turn * (p.rest[i] - center);
      Vec3 expected = center + turned + time / 0.2 * Vec3(0.1, 0, 0.04);
      EXPECT_LT((p.position(i) - expected).norm(), 1e-9);
      if (time > 0.15) continue;  // at the last keyframe it stops
      Vec3 velocity = Vec3(0.5, 0, 0.2) + Vec3(std::numbers::pi / 0.4, 0, 0).cross(turned);
      EXPECT_LT((p.velocity[i] - velocity).norm(), 1e-6);
    }
  }
}

TEST(Pin, TurnsAboutTheMiddleOfWhatItHoldsByDefault) {
  Solver solver = pinned_bar({{{"region", right}, {"rotation", Curve<Vec3>(Vec3(0, 0, 180))}}});
  const Particles& p = solver.state().particles;
  Vec3 shift = Vec3::Zero();
  double farthest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!right.contains(p.rest[i])) continue;
    shift += p.displacement[i];
    farthest = std::max(farthest, p.displacement[i].norm());
  }
  EXPECT_LT(shift.norm(), 1e-12);
  EXPECT_GT(farthest, 0.1);
}

TEST(Pin, VelocityIsTheRateOfPositionWhileTheAxisTurns) {
  Curve<Vec3> rotation(std::vector<Key>{{0.0, Vec3(40, 10, 0)}, {1.0, Vec3(-30, 90, 60)}});
  State state = lattice_box(Vec3(0.8, 0.3, 0.3), 8, 3, 3, 1000.0);
  auto effects =
      make_effects(state, std::vector<EffectRequest>{{"pin", {0, given("pin", {{"rotation", rotation}})}}});
  auto place = [&](double time) {
    state.time = time;
    effects[0]->prescribe(state);
    return state.particles;
  };
  Particles before = place(0.4 - 1e-6), after = place(0.4 + 1e-6), now = place(0.4);
  for (std::size_t i = 0; i < now.size(); ++i) {
    Vec3 rate = (after.displacement[i] - before.displacement[i]) / 2e-6;
    EXPECT_LT((rate - now.velocity[i]).norm(), 1e-8);
    EXPECT_GT(rate.norm(), 0.0);
  }
}

TEST(Pin, LetsGoAtItsReleaseButNotOfWhatAnotherHolds) {
  const Region first{.max = Vec3(0.1, 1, 1)};
  Solver solver = pinned_bar({{{"region", left}, {"release", Curve<double>(0.1)}}, {{"region", first}}});
  solver.advance(0.09);
  auto count = [&] { return std::count(solver.state().fixed.begin(), solver.state().fixed.end(), 1); };
  EXPECT_EQ(count(), 18);
  solver.advance(0.2);
  EXPECT_EQ(count(), 9);
  const Particles& p = solver.state().particles;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (left.contains(p.rest[i]) && !first.contains(p.rest[i])) {
      EXPECT_NE(p.displacement[i].z(), 0.0);
    }
}

// Where it stands does not tell: it stands there again.
TEST(Pin, TellsThatItMovedToAndFro) {
  State state = lattice_box(Vec3(0.8, 0.3, 0.3), 8, 3, 3, 1000.0);
  const Curve<Vec3> shaken(
      std::vector<Key>{{0.1, Vec3(0, 0, 0)}, {0.15, Vec3(0.05, 0, 0)}, {0.2, Vec3(0, 0, 0)}});
  for (std::string_view key : {"move", "rotation"}) {
    Values values = {{key, shaken}, {"release", Curve<double>(0.3)}};
    auto effects =
        make_effects(state, std::vector<EffectRequest>{{"pin", {0, given("pin", std::move(values))}}});
    EXPECT_FALSE(effects[0]->driven(0.0, 0.1));
    EXPECT_TRUE(effects[0]->driven(0.1, 0.2));
    EXPECT_FALSE(effects[0]->driven(0.2, 0.4));
  }
}

TEST(Pin, RefusesARegionWithoutParticles) {
  try {
    pinned_bar({{{"region", Region{.min = Vec3(5, 5, 5)}}}});
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("the region of a pin on body 'box' holds none of its 72 particles"));
  }
}

}  // namespace
}  // namespace deforma
