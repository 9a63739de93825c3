#pragma once

#include <utility>
#include <vector>

#include "sim/types.hpp"

namespace deforma {

/// What an effect keeps for each body that called for it, found by the body's index.
template <typename T>
class PerBody {
 public:
  explicit PerBody(std::size_t bodies) : place_(bodies, 0) {}

  T& add(Index body, T entry) {
    entries_.push_back({body, std::move(entry)});
    place_[body] = entries_.size();
    return entries_.back().second;
  }

  /// Null for a body without.
  const T* of(Index body) const { return place_[body] == 0 ? nullptr : &entries_[place_[body] - 1].second; }

  // Pairs of the body's index and its entry, in the order in which they were added.
  auto begin() { return entries_.begin(); }
  auto end() { return entries_.end(); }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }

  std::size_t bytes() const {
    return entries_.capacity() * sizeof(entries_[0]) + place_.capacity() * sizeof(place_[0]);
  }

 private:
  std::vector<std::pair<Index, T>> entries_;
  std::vector<std::size_t> place_;  // in `entries_`, from 1; 0 for none
};

}  // namespace deforma
