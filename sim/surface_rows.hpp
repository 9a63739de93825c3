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

/// An upper bound, particle by particle, of the squared frequencies [1/s^2] that springs of stiffness k_s at
/// the vertices give: the row sums r_i = sum_s k_s |c_si| sum_j |c_sj| / m_i of M^-1 K (Gershgorin).
/// @param stiffness k_s [N/m], one per row
/// @return one value per particle, zero where no spring acts
std::vector<double> squared_frequency_bounds(const State& state, const SurfaceRows& rows,
                                             std::span<const double> stiffness);

}  // namespace deforma
