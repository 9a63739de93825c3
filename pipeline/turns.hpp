#pragma once

#include <functional>
#include <span>
#include <vector>

namespace deforma {

/// How long things take that are measured beside each other.
struct Turns {
  enum class Clock {
    thread,  ///< processor time of the calling thread: what else runs on the machine does not count
    wall
  };
  Clock clock = Clock::thread;
  int rounds = 7;
  double seconds = 0.1;  ///< that one thing works before it is the next one's turn
};

/// Measures several things in turn, round after round, so that a machine which drifts favours none of them.
///
/// @param things each does about so much of its work as it is told (1: the least) and returns how much it was
/// @return for each the median over the rounds of seconds per unit of work
std::vector<double> take_turns(std::span<const std::function<double(double)>> things, const Turns& turns);

/// The middle value, or the mean of the two in the middle; not of nothing.
double median(std::vector<double> values);

}  // namespace deforma
