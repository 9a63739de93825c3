#pragma once

#include <functional>
#include <span>
#include <vector>

#include "sim/inner_loops.hpp"
#include "sim/kernel.hpp"
#include "sim/particles.hpp"
#include "sim/types.hpp"

namespace deforma {

/// Rest links of every particle in compressed rows, symmetric: j is in row i exactly when i is in row j.
struct Neighborhood {
  std::vector<Index> start;                            ///< n + 1 row starts
  std::vector<Link> links;                             ///< both directions of every pair
  std::vector<double> support;                         ///< h of every particle [m]
  std::vector<Place> places;                           ///< X of every particle
  std::vector<Ahead> ahead;                            ///< beside each row, or empty where all fits the cache
  Instructions instructions = fastest_instructions();  ///< that the loops are made of

  std::size_t size() const { return support.size(); }
  Range row(std::size_t i) const { return {start[i], start[i + 1]}; }
  /// W X_ij of a link of particle i [m]; the reverse link's is exactly the opposite.
  Vec3 vector(std::size_t i, const Link& link) const {
    return static_cast<double>(link.weight) *
           (Eigen::Map<const Vec3>(places[link.j].X) - Eigen::Map<const Vec3>(places[i].X));
  }
  const InnerLoops& loops() const { return inner_loops_of(instructions); }
  /// Rows of these links, or of others in the same places.
  template <typename RowLink>
  Rows<RowLink> rows(const std::vector<RowLink>& beside, Range particles) const {
    return {start.data(), beside.data(), ahead.empty() ? nullptr : ahead.data(), particles.begin,
            particles.end};
  }
};

/// How neighbours are chosen.
struct NeighborhoodSettings {
  Kernel kernel = Kernel::cubic_spline;
  int neighbors = 18;  ///< k: how many nearest particles set the mean distance; clipped to N-1, and in a body
                       ///< that is flat or straight fewer, so that they lie no farther away
  double support = 1.5;   ///< h over the mean distance of the k nearest
  bool portable = false;  ///< the same bits on any processor, at the price of some speed
};

/// Whether two particles of a body, at rest positions a and b [m], may be linked.
using LinkFilter = std::function<bool(Index body, const Vec3& a, const Vec3& b)>;

/// Links each body's particles: h_i = support * mean distance of the k nearest, and a pair is linked exactly
/// when |X_ij| < (h_i + h_j)/2, with W at that mean support radius in both directions. Bodies are never
/// linked.
///
/// @param allowed called for every pair when not empty; must be symmetric and safe to call from several
/// threads
/// @throws std::invalid_argument when k < 3, the support is not positive and finite, or a position is not
/// finite.
Neighborhood build_neighborhood(const Particles& particles, std::span<const Body> bodies,
                                const NeighborhoodSettings& settings, const LinkFilter& allowed = {});

}  // namespace deforma
