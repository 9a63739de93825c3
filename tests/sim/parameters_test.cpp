#include "sim/parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "sim/effects/registry.hpp"

namespace deforma {
namespace {

const Setting settings[] = {
    {.key = "young",
     .unit = "Pa",
     .meaning = "Young's modulus",
     .fallback = Curve<double>(1.0),
     .required = true,
     .allowed = Interval::positive()},
    {.key = "poisson",
     .unit = "-",
     .meaning = "Poisson's ratio",
     .fallback = Curve<double>(0.3),
     .allowed = Interval::open(-1.0, 0.5)},
    {.key = "material",
     .unit = "-",
     .meaning = "law",
     .fallback = std::string("soft"),
     .choices = {"soft", "hard"}},
    {.key = "pull",
     .unit = "N",
     .meaning = "force",
     .fallback = Curve<Vec3>(Vec3(0, 0, 1)),
     .keyframed = false},
    {.key = "self", .unit = "-", .meaning = "touches itself", .fallback = false},
};

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Parameters, FillInDefaultsAndKeepWhatIsSet) {
  Parameters p{settings};
  EXPECT_EQ(p.number("poisson").at(0.0), 0.3);
  p.set("poisson", Curve<double>(0.4));
  EXPECT_EQ(p.number("poisson").at(0.0), 0.4);
  EXPECT_TRUE(p.given("poisson"));
  EXPECT_FALSE(p.given("self"));
  EXPECT_EQ(p.text("material"), "soft");
  EXPECT_FALSE(p.flag("self"));
}

TEST(Parameters, RefuseByNameWithTheNearestAndTheList) {
  Parameters p{settings};
  std::string message = refusal([&] { p.set("youngs", Curve<double>(1.0)); });
  EXPECT_THAT(message, testing::HasSubstr("unknown key 'youngs'; did you mean 'young'?"));
  EXPECT_THAT(message, testing::HasSubstr("young, poisson, material, pull, self"));
  EXPECT_THAT(refusal([&] { p.set("zzzzzzzzz", Curve<double>(1.0)); }),
              testing::Not(testing::HasSubstr("did you mean")));
}

TEST(Parameters, RefuseNumbersOutsideTheIntervalAtAnyKeyframe) {
  Parameters p{settings};
  for (double bad : {0.5, -1.0, 0.6, std::nan("")})
    EXPECT_THAT(refusal([&] { p.set("poisson", Curve<double>(bad)); }),
                testing::HasSubstr("outside (-1, 0.5)"));
  EXPECT_THAT(refusal([&] { p.set("young", Curve<double>(0.0)); }),
              testing::HasSubstr("outside (0, inf) Pa"));
  std::vector<Curve<double>::Key> keys = {{0.0, 0.1}, {1.0, 0.7}};
  EXPECT_THAT(refusal([&] { p.set("poisson", Curve<double>(keys)); }), testing::HasSubstr("0.7 is outside"));
}

TEST(Parameters, RefuseOtherTypesChoicesAndKeyframes) {
  Parameters p{settings};
  EXPECT_THAT(refusal([&] { p.set("young", std::string("soft")); }),
              testing::HasSubstr("expected a number, found a text"));
  EXPECT_THAT(refusal([&] { p.set("material", std::string("sofd")); }),
              testing::HasSubstr("did you mean 'soft'?"));
  std::vector<Curve<Vec3>::Key> keys = {{0.0, Vec3::Zero()}, {1.0, Vec3::Ones()}};
  EXPECT_THAT(refusal([&] { p.set("pull", Curve<Vec3>(keys)); }), testing::HasSubstr("must be constant"));
  EXPECT_THAT(refusal([&] { p.set("pull", Curve<Vec3>(Vec3(0, std::nan(""), 0))); }),
              testing::HasSubstr("not finite"));
}

TEST(Parameters, RefuseToMissWhatIsRequired) {
  Parameters p{settings};
  EXPECT_THAT(refusal([&] { p.require_complete(); }),
              testing::HasSubstr("missing key 'young' (Young's modulus, Pa)"));
  p.set("young", Curve<double>(2.0));
  EXPECT_EQ(refusal([&] { p.require_complete(); }), "accepted");
}

TEST(Curve, IsPiecewiseLinearAndHeldBeyondItsEnds) {
  Curve<double> curve(std::vector<Curve<double>::Key>{{1.0, 10.0}, {2.0, 20.0}, {4.0, 0.0}});
  EXPECT_EQ(curve.at(0.0), 10.0);
  EXPECT_EQ(curve.at(1.5), 15.0);
  EXPECT_EQ(curve.at(3.0), 10.0);
  EXPECT_EQ(curve.at(9.0), 0.0);
  EXPECT_EQ(curve.rate(1.5), 10.0);
  EXPECT_EQ(curve.rate(3.0), -10.0);
  EXPECT_EQ(curve.rate(0.0), 0.0);
  EXPECT_EQ(curve.rate(9.0), 0.0);
}

TEST(Curve, RefusesNoKeysAndTimesThatDoNotIncrease) {
  using Keys = std::vector<Curve<double>::Key>;
  EXPECT_THAT(refusal([] { Curve<double> curve(Keys{}); }), testing::HasSubstr("at least one"));
  EXPECT_THAT(refusal([] {
                Curve<double> curve(Keys{{1.0, 0.0}, {1.0, 2.0}});
              }),
              testing::HasSubstr("1 after 1"));
  EXPECT_THAT(refusal([] { Curve<double> curve(Keys{{std::nan(""), 0.0}}); }), testing::HasSubstr("finite"));
}

TEST(NearestName, FindsTyposAndNothingFarAway) {
  std::vector<std::string_view> names = {"elastic", "volume", "lennard_jones"};
  EXPECT_EQ(nearest_name("elastc", names), "elastic");
  EXPECT_EQ(nearest_name("lenard_jones", names), "lennard_jones");
  EXPECT_EQ(nearest_name("xyz", names), "");
}

TEST(Registry, GivesEveryEffectANameASummaryAndSettingsWithUnits) {
  for (const EffectInfo& info : effect_registry()) {
    EXPECT_FALSE(info.name.empty());
    EXPECT_FALSE(info.summary.empty()) << info.name;
    EXPECT_FALSE(info.settings.empty()) << info.name;
    for (const Setting& setting : info.settings) {
      EXPECT_FALSE(setting.unit.empty()) << info.name << "." << setting.key;
      EXPECT_FALSE(setting.meaning.empty()) << info.name << "." << setting.key;
      EXPECT_EQ(std::holds_alternative<std::string>(setting.fallback), !setting.choices.empty())
          << info.name << "." << setting.key;
    }
  }
}

TEST(Registry, RefusesAnUnknownEffectWithTheNearest) {
  EXPECT_THAT(refusal([] { find_effect("elastik"); }), testing::HasSubstr("did you mean 'elastic'?"));
}

}  // namespace
}  // namespace deforma
