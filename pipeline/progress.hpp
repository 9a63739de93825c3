#pragma once

#include <chrono>
#include <string>

namespace deforma {

/// Tells on standard error how far a run has come: a bar on a terminal, plain lines otherwise, or nothing.
class Progress {
 public:
  enum class Style { quiet, lines, bar };

  explicit Progress(Style style) : style_(style) {}
  ~Progress() { end(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `quiet` when asked for, else by what standard error is.
  static Style style_for(bool quiet);

  /// @param what is done, one after another
  void begin(int first_frame, int last_frame, std::string what = "frame");
  void frame_done(int frame);
  void end();  ///< leaves the bar's line, so that what is said next has one of its own

 private:
  using Clock = std::chrono::steady_clock;

  Style style_;
  std::string what_;
  int first_ = 1;
  int last_ = 1;
  bool in_bar_ = false;  ///< the cursor stands behind a bar
  int said_tenth_ = 0;   ///< of the frames, in plain lines
  Clock::time_point start_;
};

}  // namespace deforma
