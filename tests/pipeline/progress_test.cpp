#include "pipeline/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace deforma {
namespace {

std::string said_by(Progress::Style style, int frames) {
  testing::internal::CaptureStderr();
  {
    Progress progress(style);
    progress.begin(1, 10);
    for (int frame = 1; frame <= frames; ++frame) progress.frame_done(frame);
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, ABarThatEndsEarlyLeavesItsLine) {
  std::string said = said_by(Progress::Style::bar, 3);
  EXPECT_THAT(said, testing::HasSubstr("frame 3/10"));
  EXPECT_THAT(said, testing::EndsWith("\n"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
  EXPECT_EQ(said_by(Progress::Style::bar, 0), "");
}

TEST(Progress, LinesAndQuietHaveNoBar) {
  std::string said = said_by(Progress::Style::lines, 10);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 10);
  EXPECT_EQ(said.find('\r'), said.npos);
  EXPECT_EQ(said_by(Progress::Style::quiet, 10), "");
}

}  // namespace
}  // namespace deforma
