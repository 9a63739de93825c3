#include "render/palette.hpp"

#include <algorithm>
#include <limits>

namespace deforma {
namespace {

using Rgb = std::array<int, 3>;

// Colours are counted in cells of 4 levels a side.
constexpr int bits = 6;
constexpr int levels = 1 << bits;
constexpr int cell_count = levels * levels * levels;
constexpr int step = 256 / levels;

struct Cell {
  Rgb color = {};  // sums, then means
  std::int64_t pixels = 0;
};

std::size_t cell_of(const Rgb& color) {
  return static_cast<std::size_t>((color[0] / step * levels + color[1] / step) * levels + color[2] / step);
}

struct Group {
  std::vector<Cell>::iterator begin, end;
  std::int64_t pixels = 0;
  int widest = 0;          // channel
  std::int64_t worth = 0;  // of being cut

  Group(std::vector<Cell>::iterator first, std::vector<Cell>::iterator last) : begin(first), end(last) {
    int extent = 0;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      int low = 255, high = 0;
      for (auto cell = begin; cell != end; ++cell) {
        low = std::min(low, cell->color[channel]);
        high = std::max(high, cell->color[channel]);
      }
      if (high - low > extent) {
        extent = high - low;
        widest = static_cast<int>(channel);
      }
    }
    for (auto cell = begin; cell != end; ++cell) pixels += cell->pixels;
    worth = pixels * extent * extent;
  }

  /// The cell where half of the pixels lie to either side, both sides kept non-empty.
  std::vector<Cell>::iterator cut() {
    const auto channel = static_cast<std::size_t>(widest);
    std::stable_sort(begin, end,
                     [&](const Cell& a, const Cell& b) { return a.color[channel] < b.color[channel]; });
    std::int64_t seen = 0;
    auto middle = begin;
    while (middle != end && 2 * seen < pixels) seen += (middle++)->pixels;
    return std::clamp(middle, begin + 1, end - 1);
  }

  Rgb mean() const {
    std::array<std::int64_t, 3> sum = {};
    for (auto cell = begin; cell != end; ++cell)
      for (std::size_t channel = 0; channel < 3; ++channel)
        sum[channel] += cell->color[channel] * cell->pixels;
    Rgb color = {};
    for (std::size_t channel = 0; channel < 3; ++channel)
      color[channel] = static_cast<int>((sum[channel] + pixels / 2) / pixels);
    return color;
  }
};

std::vector<Cell> count_colors(const Image& image) {
  std::vector<std::array<std::int64_t, 4>> sums(cell_count);
  for (std::size_t at = 0; at < image.rgba.size(); at += 4) {
    const Rgb color = {image.rgba[at], image.rgba[at + 1], image.rgba[at + 2]};
    auto& sum = sums[cell_of(color)];
    for (std::size_t channel = 0; channel < 3; ++channel) sum[channel] += color[channel];
    ++sum[3];
  }
  std::vector<Cell> cells;
  for (const auto& sum : sums) {
    if (sum[3] == 0) continue;
    Cell cell;
    for (std::size_t channel = 0; channel < 3; ++channel)
      cell.color[channel] = static_cast<int>(sum[channel] / sum[3]);
    cell.pixels = sum[3];
    cells.push_back(cell);
  }
  return cells;
}

std::vector<Rgb> median_cut(std::vector<Cell>& cells) {
  std::vector<Group> groups = {Group(cells.begin(), cells.end())};
  while (groups.size() < 256) {
    const auto best = std::max_element(groups.begin(), groups.end(),
                                       [](const Group& a, const Group& b) { return a.worth < b.worth; });
    if (best->worth == 0 || best->end - best->begin < 2) break;
    const auto middle = best->cut();
    const Group second(middle, best->end);
    *best = Group(best->begin, middle);
    groups.push_back(second);
  }
  std::vector<Rgb> colors;
  for (const Group& group : groups) colors.push_back(group.mean());
  return colors;
}

std::uint8_t nearest(const std::vector<Rgb>& colors, const Rgb& wanted) {
  std::size_t best = 0;
  int least = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < colors.size(); ++i) {
    int distance = 0;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const int difference = colors[i][channel] - wanted[channel];
      distance += difference * difference;
    }
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return static_cast<std::uint8_t>(best);
}

}  // namespace

IndexedImage index_colors(const Image& image) {
  std::vector<Cell> cells = count_colors(image);
  const std::vector<Rgb> colors = median_cut(cells);
  IndexedImage indexed;
  for (std::size_t i = 0; i < indexed.palette.size(); ++i) {
    const Rgb& color = colors[std::min(i, colors.size() - 1)];
    indexed.palette[i] = 0xff000000u | static_cast<std::uint32_t>(color[0] << 16 | color[1] << 8 | color[2]);
  }
  constexpr int pattern[16] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
  std::vector<std::int16_t> known(cell_count, -1);
  indexed.indices.resize(image.rgba.size() / 4);
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t i = 0; i < indexed.indices.size(); ++i) {
    const int shift = (pattern[(i / width % 4) * 4 + i % width % 4] - 8) / 2;
    Rgb color;
    for (std::size_t channel = 0; channel < 3; ++channel)
      color[channel] = std::clamp(image.rgba[4 * i + channel] + shift, 0, 255);
    std::int16_t& index = known[cell_of(color)];
    if (index < 0) {
      for (int& level : color) level = level / step * step + step / 2;
      index = nearest(colors, color);
    }
    indexed.indices[i] = static_cast<std::uint8_t>(index);
  }
  return indexed;
}

}  // namespace deforma
