#pragma once

#include <span>
#include <utility>
#include <vector>

#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// The skin (eq 25) with its gradients (eqs 6-8) multiplied out: u_s = sum_i c_si u_i over all the particles
/// that move vertex s, sum_i c_si = 1 (where neighbourhoods span space). Large: made to measure stiffness,
/// then dropped.
struct SurfaceRows {
  using Entry = std::pair<Index, double>;  ///< particle, c_si

  Index first = 0;           ///< the vertex of row 0
  std::vector<Index> start;  ///< a row for each vertex, plus one
  std::vector<Entry> entries;

  std::span<const Entry> row(std::size_t s) const {
    return {entries.data() + start[s - first], entries.data() + start[s - first + 1]};
  }

  /// sum_i |c_si|: how much faster than its particles the vertex can move.
  double gain(std::size_t s) const;
};

/// @param vertices which rows to make
SurfaceRows make_surface_rows(const State& state, Range vertices);

/// The largest squared frequency [1/s^2] that springs of stiffness k_s at the vertices give: the greatest eigenvalue of
/// M^-1 sum_s k_s c_s c_s^T, by power iteration, 5 % added for what it has left to grow.
/// @param stiffness k_s [N/m], one per row
double largest_squared_frequency(const State& state, const SurfaceRows& rows,
                                 std::span<const double> stiffness);

}  // namespace deforma
