#include "sim/kernel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace deforma {
namespace {

class EveryKernel : public testing::TestWithParam<int> {
 protected:
  Kernel kernel() const { return static_cast<Kernel>(GetParam()); }
};

TEST_P(EveryKernel, IntegratesToOne) {
  const double h = 0.37;
  const int n = 20000;
  double sum = 0.0;
  for (int s = 0; s < n; ++s) {
    double r = (s + 0.5) / n * h;
    sum += 4.0 * std::numbers::pi * r * r * kernel_weight(kernel(), r, h) * h / n;
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST_P(EveryKernel, FallsToZeroAtTheSupportRadius) {
  double before = kernel_weight(kernel(), 0.0, 2.0);
  for (double r = 0.02; r < 2.0; r += 0.02) {
    double now = kernel_weight(kernel(), r, 2.0);
    EXPECT_LT(now, before) << r;
    EXPECT_GT(now, 0.0) << r;
    before = now;
  }
  EXPECT_EQ(kernel_weight(kernel(), 2.0, 2.0), 0.0);
}

TEST_P(EveryKernel, KeepsItsNameBothWays) { EXPECT_EQ(kernel_from_name(kernel_name(kernel())), kernel()); }

INSTANTIATE_TEST_SUITE_P(Kernel, EveryKernel, testing::Range(1, 6));

TEST(Kernel, HasThePrintedShapes) {
  // Ratios to the value at the centre, from eqs 11-15 by hand at q = 1/4.
  auto ratio = [](Kernel kernel) { return kernel_weight(kernel, 0.25) / kernel_weight(kernel, 0.0); };
  EXPECT_NEAR(ratio(Kernel::poly6), std::pow(1.0 - 1.0 / 16.0, 3), 1e-14);
  EXPECT_NEAR(ratio(Kernel::gaussian), std::exp(-0.0625 / 0.16), 1e-14);
  EXPECT_NEAR(ratio(Kernel::cubic_spline), (2.0 / 3.0 - 0.25 + 0.0625) / (2.0 / 3.0), 1e-14);
  EXPECT_NEAR(ratio(Kernel::quartic), 1.0 - 6.0 / 16.0 + 8.0 / 64.0 - 3.0 / 256.0, 1e-14);
  EXPECT_EQ(kernel_weight(Kernel::wide_cubic_spline, 0.25), kernel_weight(Kernel::cubic_spline, 0.25));
}

TEST(Kernel, RefusesAnUnknownNameWithTheList) {
  try {
    kernel_from_name("poly7");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'poly7'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("poly6, gaussian, cubic_spline"));
  }
}

}  // namespace
}  // namespace deforma
