#include "sim/surface_rows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
      const double c = state.fit.quadratic() ? tie.weight * gradient_vector(state.fit.there[l]).dot(tie.arm)
                                             : state.links.vector(i, state.links.links[l]).dot(lever);
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

double largest_squared_frequency(const State& state, const SurfaceRows& rows,
                                 std::span<const double> stiffness) {
  // Rough, so that no symmetry of the body hides the highest mode from it.
  std::vector<double> u(state.size()), answer(state.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = 1.0 + 0.5 * std::sin(12.9898 * static_cast<double>(i));
  double largest = 0.0;
  for (int iteration = 0; iteration < 50; ++iteration) {
    std::fill(answer.begin(), answer.end(), 0.0);
    for (std::size_t k = 0; k < stiffness.size(); ++k) {
      const auto row = rows.row(rows.first + k);
      double moved = 0.0;
      for (const auto& [i, c] : row) moved += c * u[i];
      for (const auto& [i, c] : row) answer[i] += c * stiffness[k] * moved;
    }
    double across = 0.0, along = 0.0, size = 0.0;  // Rayleigh's quotient in the scalar product of the masses
    for (std::size_t i = 0; i < u.size(); ++i) {
      across += u[i] * answer[i];
      along += u[i] * u[i] * state.particles.mass[i];
      answer[i] /= state.particles.mass[i];
      size = std::max(size, std::abs(answer[i]));
    }
    if (!(size > 0.0)) return 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = answer[i] / size;
    const double before = std::exchange(largest, across / along);
    if (iteration > 5 && largest < 1.002 * before) break;
  }
  return 1.05 * largest;
}

}  // namespace deforma
