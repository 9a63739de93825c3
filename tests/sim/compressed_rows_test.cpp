#include "sim/compressed_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace deforma {
namespace {

TEST(CompressedRows, BringsRowsFromManyBlocksInOrder) {
  constexpr Index count = 3000;
  CompressedRows<Index> rows;
  auto find = [](Range part, CompressedRows<Index>::Block& block) {
    for (Index i = part.begin; i < part.end; ++i) {
      for (Index k = 0; k < i % 7; ++k) block.add(10 * i + k);
      block.end_row();
    }
  };
  rows.find({0, 1}, find);
  rows.find({1, 1}, find);
  rows.find({1, 2000}, find);
  rows.find({2500, count}, find);  // nobody looked for those between

  std::vector<Index> start, items;
  rows.take(count, start, items);
  ASSERT_EQ(start.size(), count + 1);
  EXPECT_EQ(start.back(), items.size());
  for (Index i = 0; i < count; ++i) {
    std::vector<Index> expected(i >= 2000 && i < 2500 ? 0 : i % 7);
    std::iota(expected.begin(), expected.end(), 10 * i);
    EXPECT_EQ(std::vector<Index>(items.begin() + start[i], items.begin() + start[i + 1]), expected) << i;
  }
}

TEST(CompressedRows, MayBeNone) {
  CompressedRows<int> rows;
  std::vector<Index> start;
  std::vector<int> items{1};
  rows.take(2, start, items);
  EXPECT_THAT(start, testing::ElementsAre(0, 0, 0));
  EXPECT_TRUE(items.empty());
}

}  // namespace
}  // namespace deforma
