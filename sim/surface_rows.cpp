#include "sim/surface_rows.hpp"

#include <algorithm>
#include <cmath>

#include "sim/parallel.hpp"

namespace deforma {
namespace {

std::vector<SurfaceRows::Entry> make_row(const State& state, std::size_t s) {
  std::vector<SurfaceRows::Entry> row;
  for (const Skin::Tie& tie : state.surface.skin.row(s)) {
    const Index i = tie.particle;
    const Vec3 lever = tie.weight * (state.fit.inverse[i] * tie.arm);
    double own = tie.weight;
    const Range links = state.links.row(i);
    for (Index l = links.begin; l < links.end; ++l) {
      const double c = state.links.links[l].vector().dot(lever);
      row.emplace_back(state.links.links[l].j, c);
      own -= c;
    }
    row.emplace_back(i, own);
  }
  std::stable_sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (kept > 0 && row[kept - 1].first == row[k].first)
      row[kept - 1].second += row[k].second;
    else
      row[kept++] = row[k];
  }
  row.resize(kept);
  return row;
}

}  // namespace

double SurfaceRows::gain(std::size_t s) const {
  double sum = 0.0;
  for (const Entry& entry : row(s)) sum += std::abs(entry.second);
  return sum;
}

SurfaceRows make_surface_rows(const State& state, Range vertices) {
  std::vector<std::vector<SurfaceRows::Entry>> made(vertices.size());
  parallel_for_each(
      made.size(), [&](std::size_t k) { made[k] = make_row(state, vertices.begin + k); }, 64);
  SurfaceRows rows;
  rows.first = vertices.begin;
  rows.start.push_back(0);
  for (const auto& row : made) {
    rows.entries.insert(rows.entries.end(), row.begin(), row.end());
    rows.start.push_back(static_cast<Index>(rows.entries.size()));
  }
  return rows;
}

std::vector<double> squared_frequency_bounds(const State& state, const SurfaceRows& rows,
                                             std::span<const double> stiffness) {
  std::vector<double> bound(state.size(), 0.0);
  for (std::size_t k = 0; k < stiffness.size(); ++k) {
    const std::size_t s = rows.first + k;
    const double gain = rows.gain(s);
    for (const auto& [i, c] : rows.row(s))
      bound[i] += stiffness[k] * std::abs(c) * gain / state.particles.mass[i];
  }
  return bound;
}

}  // namespace deforma
