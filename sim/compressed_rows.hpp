#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <vector>

#include "sim/parallel.hpp"
#include "sim/types.hpp"

namespace deforma {

/// Rows whose lengths are known only once they have been found, brought one after another into one array: blocks of
/// rows are found in parallel, each into an array of its own, and copied when all lengths are known.
template <typename Item>
class CompressedRows {
 public:
  /// The rows of one block, from the first on.
  class Block {
   public:
    void add(const Item& item) { items_.push_back(item); }
    void end_row() { ends_.push_back(static_cast<Index>(items_.size())); }

   private:
    friend class CompressedRows;
    Index first_row_ = 0;
    std::vector<Index> ends_;
    std::vector<Item> items_;
  };

  /// Finds the rows of a range, none of which was found before.
  /// @param find called with a part of the range and its `Block`; adds every row's items and ends it. Runs on one thread.
  template <typename Find>
  void find(Range rows, const Find& find) {
    const std::size_t before = blocks_.size();
    blocks_.resize(before + (rows.size() + block_size - 1) / block_size);
    // Arrays grow in one place for each thread; what is kept is a copy without slack.
    tbb::enumerable_thread_specific<Block> growing;
    parallel_for_each(
        blocks_.size() - before,
        [&](std::size_t k) {
          Range part{rows.begin + static_cast<Index>(k) * block_size, 0};
          part.end = std::min(part.begin + block_size, rows.end);
          Block& block = growing.local();
          block.first_row_ = part.begin;
          block.ends_.clear();
          block.items_.clear();
          find(part, block);
          blocks_[before + k] = block;
        },
        1);
  }

  /// Writes `count` rows and forgets them; rows that were not found are empty.
  /// @param start written  count + 1
  void take(std::size_t count, std::vector<Index>& start, std::vector<Item>& items) {
    start.assign(count + 1, 0);
    for (const Block& block : blocks_) {
      Index end = 0;
      for (std::size_t r = 0; r < block.ends_.size(); ++r) {
        start[block.first_row_ + r + 1] = block.ends_[r] - end;
        end = block.ends_[r];
      }
    }
    for (std::size_t i = 0; i < count; ++i) start[i + 1] += start[i];
    items.resize(start[count]);
    parallel_for_each(
        blocks_.size(),
        [&](std::size_t k) {
          std::copy(blocks_[k].items_.begin(), blocks_[k].items_.end(),
                    items.begin() + start[blocks_[k].first_row_]);
          blocks_[k] = {};
        },
        1);
    blocks_.clear();
  }

 private:
  static constexpr Index block_size = 512;

  std::vector<Block> blocks_;
};

}  // namespace deforma
