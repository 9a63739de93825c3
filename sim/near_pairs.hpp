#pragma once

#include <functional>
#include <span>
#include <vector>

#include "sim/particles.hpp"
#include "sim/types.hpp"

namespace deforma {

/// Pairs of particles that are near each other now, found by a grid and kept until something has moved.
///
/// Rows hold both directions of every pair, so that each particle can gather what acts on it.
class NearPairs {
 public:
  /// Whether two particles may form a pair; must be symmetric.
  using Accept = std::function<bool(Index i, Index j)>;

  /// @param reach  every accepted pair no farther apart than this is listed [m]
  /// @param margin how much farther the search looks, so that it need not be repeated at once [m]
  /// @throws std::invalid_argument unless both are positive and finite.
  NearPairs(double reach, double margin);

  /// Searches again when some member has moved more than half the margin since the last search.
  /// @param members particles that take part, always the same
  void update(const Particles& particles, std::span<const Index> members, const Accept& accept);

  /// The partners of particle i, ascending; some are farther away than the reach.
  std::span<const Index> of(std::size_t i) const {
    return {partners_.data() + start_[i], partners_.data() + start_[i + 1]};
  }
  bool empty() const { return partners_.empty(); }
  std::size_t bytes() const;

 private:
  bool moved(const Particles& particles, std::span<const Index> members) const;
  void search(const Particles& particles, std::span<const Index> members, const Accept& accept);

  double reach_, margin_;
  std::vector<Vec3> searched_;  // displacement of each member at the last search
  std::vector<std::size_t> start_;
  std::vector<Index> partners_;
};

}  // namespace deforma
