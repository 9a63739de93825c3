#include "pipeline/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace deforma {

namespace {

std::string clock_text(double seconds) {
  int whole = static_cast<int>(std::lround(seconds));
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

Progress::Style Progress::style_for(bool quiet) {
  if (quiet) return Style::quiet;
  return isatty(STDERR_FILENO) ? Style::bar : Style::lines;
}

void Progress::begin(int first_frame, int last_frame, std::string what) {
  what_ = std::move(what);
  first_ = first_frame;
  last_ = last_frame;
  said_tenth_ = 0;
  start_ = Clock::now();
}

void Progress::frame_done(int frame) {
  if (style_ == Style::quiet) return;
  int done = frame - first_ + 1;
  int total = last_ - first_ + 1;
  double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  double rate = done / std::max(elapsed, 1e-9);
  std::string left = clock_text((total - done) / rate);
  if (style_ == Style::bar) {
    constexpr int width = 30;
    int filled = width * done / total;
    fmt::print(stderr, "\r[{:#>{}}{:.>{}}] {} {}/{}  {:.1f} fps  {} left ", "", filled, "", width - filled,
               what_, frame, last_, rate, left);
    std::fflush(stderr);
    in_bar_ = true;
    return;
  }
  int tenth = 10 * done / total;
  if (tenth == said_tenth_) return;
  said_tenth_ = tenth;
  fmt::print(stderr, "{} {}/{}  {:.1f} fps  {} left\n", what_, frame, last_, rate, left);
}

void Progress::end() {
  if (in_bar_) fmt::print(stderr, "\n");
  in_bar_ = false;
}

}  // namespace deforma
