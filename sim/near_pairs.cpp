#include "sim/near_pairs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "sim/parallel.hpp"

namespace deforma {
namespace {

constexpr int bits = 20;  // of each coordinate of a cell in its key

// Cells over the members' bounding box; at most 2^20 along each side, so that a key fits in 64 bits.
struct Grid {
  Vec3 low;
  double cell;

  Grid(const Particles& particles, std::span<const Index> members, double wanted) : cell(wanted) {
    low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    for (Index i : members) {
      low = low.cwiseMin(particles.position(i));
      high = high.cwiseMax(particles.position(i));
    }
    cell = std::max(cell, (high - low).maxCoeff() / ((1 << bits) - 4));
  }
  // One more than the cell's number, so that its neighbours' keys never go below zero.
  std::uint64_t along(double x, int axis) const {
    return static_cast<std::uint64_t>(std::floor((x - low[axis]) / cell)) + 1;
  }
  static std::uint64_t key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return (((x << bits) | y) << bits) | z;
  }
};

}  // namespace

NearPairs::NearPairs(double reach, double margin) : reach_(reach), margin_(margin) {
  if (!(reach > 0.0 && margin > 0.0 && std::isfinite(reach) && std::isfinite(margin)))
    throw std::invalid_argument(
        fmt::format("near pairs need a positive reach and margin, found {} m and {} m", reach, margin));
}

void NearPairs::update(const Particles& particles, std::span<const Index> members, const Accept& accept) {
  if (start_.empty() || moved(particles, members)) search(particles, members, accept);
}

bool NearPairs::moved(const Particles& particles, std::span<const Index> members) const {
  const double limit = 0.25 * margin_ * margin_;
  for (std::size_t k = 0; k < members.size(); ++k)
    if (!((particles.displacement[members[k]] - searched_[k]).squaredNorm() <= limit)) return true;
  return false;
}

void NearPairs::search(const Particles& particles, std::span<const Index> members, const Accept& accept) {
  searched_.resize(members.size());
  for (std::size_t k = 0; k < members.size(); ++k) searched_[k] = particles.displacement[members[k]];
  start_.assign(particles.size() + 1, 0);
  partners_.clear();
  if (members.empty()) return;

  const double reach = reach_ + margin_;
  const Grid grid(particles, members, reach);
  std::vector<std::pair<std::uint64_t, Index>> cells(members.size());
  for (std::size_t k = 0; k < members.size(); ++k) {
    const Vec3 x = particles.position(members[k]);
    cells[k] = {Grid::key(grid.along(x[0], 0), grid.along(x[1], 1), grid.along(x[2], 2)), members[k]};
  }
  std::sort(cells.begin(), cells.end());

  std::vector<std::vector<Index>> found(members.size());
  parallel_for_each(
      members.size(),
      [&](std::size_t k) {
        const Index i = members[k];
        const Vec3 x = particles.position(i);
        const std::uint64_t a = grid.along(x[0], 0), b = grid.along(x[1], 1), c = grid.along(x[2], 2);
        for (std::uint64_t p = a - 1; p <= a + 1; ++p)
          for (std::uint64_t q = b - 1; q <= b + 1; ++q) {  // three cells in a row have consecutive keys
            auto cell =
                std::lower_bound(cells.begin(), cells.end(), std::pair(Grid::key(p, q, c - 1), Index{0}));
            for (; cell != cells.end() && cell->first <= Grid::key(p, q, c + 1); ++cell) {
              const Index j = cell->second;
              if (j != i && (particles.position(j) - x).squaredNorm() <= reach * reach && accept(i, j))
                found[k].push_back(j);
            }
          }
        std::sort(found[k].begin(), found[k].end());
      },
      64);
  for (std::size_t k = 0; k < members.size(); ++k) start_[members[k] + 1] = found[k].size();
  for (std::size_t i = 0; i < particles.size(); ++i) start_[i + 1] += start_[i];
  partners_.resize(start_.back());
  for (std::size_t k = 0; k < members.size(); ++k)
    std::copy(found[k].begin(), found[k].end(),
              partners_.begin() + static_cast<std::ptrdiff_t>(start_[members[k]]));
}

std::size_t NearPairs::bytes() const {
  return searched_.capacity() * sizeof(Vec3) + start_.capacity() * sizeof(std::size_t) +
         partners_.capacity() * sizeof(Index);
}

}  // namespace deforma
