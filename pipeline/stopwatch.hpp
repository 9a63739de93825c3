#pragma once

#include <chrono>
#include <ctime>

namespace deforma {

/// Time that a stage worked and that it waited for others [s].
struct Load {
  double busy = 0.0;
  double wait = 0.0;
};

/// Seconds since it was made or last read.
class Stopwatch {
 public:
  double lap() {
    auto now = std::chrono::steady_clock::now();
    double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The same of the processor time that the calling thread takes; read it from that thread only.
class ThreadStopwatch {
 public:
  double lap() {
    double now = thread_time();
    double seconds = now - start_;
    start_ = now;
    return seconds;
  }

 private:
  static double thread_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  double start_ = thread_time();
};

}  // namespace deforma
