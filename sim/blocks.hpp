#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "sim/particles.hpp"
#include "sim/types.hpp"

namespace deforma {

/// A run of particles of one body that is worked on at once: so few that what one stage leaves for the next is still
/// in the cache, so many that threads have enough to do.
struct Block {
  static constexpr Index most = 128;

  Index body = 0;
  Range particles;

  std::size_t size() const { return particles.size(); }
};

/// Every body cut into blocks, in order.
inline std::vector<Block> make_blocks(std::span<const Body> bodies) {
  std::vector<Block> blocks;
  for (Index b = 0; b < bodies.size(); ++b)
    for (Index begin = bodies[b].particles.begin; begin < bodies[b].particles.end; begin += Block::most)
      blocks.push_back({b, {begin, std::min(begin + Block::most, bodies[b].particles.end)}});
  return blocks;
}

/// A block's part of an array of all particles.
template <typename T>
std::span<T> part(std::vector<T>& all, const Block& block) {
  return std::span<T>(all).subspan(block.particles.begin, block.size());
}
template <typename T>
std::span<const T> part(const std::vector<T>& all, const Block& block) {
  return std::span<const T>(all).subspan(block.particles.begin, block.size());
}

}  // namespace deforma
