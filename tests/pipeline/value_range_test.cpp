#include "pipeline/value_range.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace deforma {
namespace {

std::array<double, 2> range_of(std::string_view field, const std::vector<float>& values,
                               bool symmetric = false) {
  ValueRange range(find_field(field), symmetric);
  range.add(values);
  return range.range();
}

std::vector<float> evenly(double low, double high, int count = 10000) {
  std::vector<float> values;
  for (int i = 0; i < count; ++i) values.push_back(static_cast<float>(low + (high - low) * i / (count - 1)));
  return values;
}

TEST(ValueRange, EndsAtRoundNumbersOutsideNearlyAllValues) {
  EXPECT_EQ(range_of("von_mises", evenly(0.0, 43210.0)), (std::array<double, 2>{0.0, 44000.0}));
  EXPECT_EQ(range_of("displacement", evenly(0.2, 0.9)), (std::array<double, 2>{0.0, 0.9})) << "from rest on";
}

TEST(ValueRange, AFewExtremesDoNotSpreadIt) {
  std::vector<float> values = evenly(0.0, 1000.0);
  values.insert(values.end(), {5e6f, 7e6f, INFINITY, NAN});
  EXPECT_EQ(range_of("von_mises", values), (std::array<double, 2>{0.0, 1000.0}));
  ValueRange range(find_field("von_mises"), false);
  range.add(values);
  EXPECT_EQ(range.highest(), 7e6);
  EXPECT_EQ(range.lowest(), 0.0);
}

TEST(ValueRange, SeesSmallChangesOfARatio) {
  const auto [low, high] = range_of("det_f", evenly(0.9996, 1.0002), false);
  EXPECT_NEAR(low, 0.9996, 3e-5);
  EXPECT_NEAR(high, 1.0002, 3e-5);
}

TEST(ValueRange, HasRestInTheMiddleForADivergingMap) {
  const auto [low, high] = range_of("det_f", evenly(0.7, 1.1), true);
  EXPECT_NEAR(low, 0.7, 1e-9);
  EXPECT_NEAR(high, 1.3, 1e-9);
}

TEST(ValueRange, DoesNotDependOnHowValuesCame) {
  const std::vector<float> values = evenly(-3.0, 8.0);
  ValueRange one(find_field("det_f"), false), other(find_field("det_f"), false);
  one.add(values);
  for (std::size_t i = values.size(); i-- > 0;) other.add(std::span(values).subspan(i, 1));
  EXPECT_EQ(one.range(), other.range());
}

TEST(ValueRange, IsARangeEvenOfNothing) {
  for (const FieldInfo& field : field_registry())
    for (const std::vector<float>& values :
         {std::vector<float>{}, std::vector<float>(100, static_cast<float>(field.at_rest)),
          std::vector<float>{NAN}}) {
      const auto [low, high] = range_of(field.name, values);
      EXPECT_LT(low, high) << field.name;
      EXPECT_LE(low, field.at_rest);
      EXPECT_GE(high, field.at_rest);
    }
}

}  // namespace
}  // namespace deforma
