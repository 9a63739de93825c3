#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "sim/types.hpp"

namespace deforma {

/// A quantity over time: constant, or piecewise linear between keyframes and held beyond the first and last.
template <typename T>
class Curve {
 public:
  using Key = std::pair<double, T>;  ///< time [s], value

  /// A constant.
  Curve(T constant) : keys_{{0.0, std::move(constant)}} {}

  /// @param keys at least one, times finite and strictly increasing [s]
  /// @throws std::invalid_argument when they are not.
  explicit Curve(std::vector<Key> keys) : keys_(std::move(keys)) {
    if (keys_.empty()) throw std::invalid_argument("a list of keyframes needs at least one [time, value]");
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      if (!std::isfinite(keys_[k].first)) throw std::invalid_argument("keyframe times must be finite");
      if (k > 0 && !(keys_[k - 1].first < keys_[k].first))
        throw std::invalid_argument(fmt::format("keyframe times must increase, found {} after {}",
                                                keys_[k].first, keys_[k - 1].first));
    }
  }

  /// The value at `time` [s].
  T at(double time) const {
    auto next = std::upper_bound(keys_.begin(), keys_.end(), time,
                                 [](double t, const Key& key) { return t < key.first; });
    if (next == keys_.begin()) return keys_.front().second;
    if (next == keys_.end()) return keys_.back().second;
    auto previous = std::prev(next);
    double s = (time - previous->first) / (next->first - previous->first);
    return T(previous->second + s * (next->second - previous->second));
  }

  /// The slope at `time` [1/s], zero where the value is held.
  T rate(double time) const {
    auto next = std::upper_bound(keys_.begin(), keys_.end(), time,
                                 [](double t, const Key& key) { return t < key.first; });
    if (next == keys_.begin() || next == keys_.end()) return T(0.0 * keys_.front().second);
    auto previous = std::prev(next);
    return T((next->second - previous->second) / (next->first - previous->first));
  }

  bool varies() const { return keys_.size() > 1; }

  /// Whether it takes more than one value between two times [s].
  bool varies(double from, double to) const {
    const T first = at(from);
    return at(to) != first || std::any_of(keys_.begin(), keys_.end(), [&](const Key& key) {
             return from < key.first && key.first < to && key.second != first;
           });
  }
  const std::vector<Key>& keys() const { return keys_; }

 private:
  std::vector<Key> keys_;
};

}  // namespace deforma
