#include "pipeline/turns.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/stopwatch.hpp"

namespace deforma {

namespace {

struct Measured {
  double seconds;
  double work;

  double each() const { return seconds / work; }
};

Measured measure(const std::function<double(double)>& thing, double amount, Turns::Clock clock) {
  Stopwatch wall;
  ThreadStopwatch own;
  const double work = thing(amount);
  return {clock == Turns::Clock::wall ? wall.lap() : own.lap(), work};
}

/// How much of its work fits into a turn. The first trial finds memory and caches cold; the second tells better.
double fitting(const std::function<double(double)>& thing, const Turns& turns) {
  double amount = 1.0;
  for (double share : {0.25, 1.0}) {
    const double each = measure(thing, amount, turns.clock).each();
    amount = std::max(1.0, std::floor(share * turns.seconds / std::max(each, 1e-9)));
  }
  return amount;
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

std::vector<double> take_turns(std::span<const std::function<double(double)>> things, const Turns& turns) {
  std::vector<double> amount;
  for (const auto& thing : things) amount.push_back(fitting(thing, turns));
  std::vector<std::vector<double>> each(things.size());
  for (int round = 0; round < turns.rounds; ++round)
    for (std::size_t k = 0; k < things.size(); ++k)
      each[k].push_back(measure(things[k], amount[k], turns.clock).each());
  std::vector<double> medians;
  for (std::vector<double>& values : each) medians.push_back(median(std::move(values)));
  return medians;
}

}  // namespace deforma
