#pragma once

#include <vector>

#include "sim/particles.hpp"

namespace deforma {

/// Distances below this share of a body's spacing count as none: a link that short would outweigh all others, and one
/// of length 0 has no direction.
inline constexpr double coincident_share = 1e-6;

/// Makes one particle of all those of a body that stand in one place: it stays where the first of them is, has their
/// masses and volumes together, their mean displacement by mass, and their common momentum. A body that loses
/// particles gets the wider spacing (V/N)^(1/3) of those left; particles and ranges after them move up. Bodies are
/// never merged with each other.
/// @return how many particles each body lost
/// @throws std::invalid_argument when a rest position is not finite.
std::vector<std::size_t> merge_coincident(Particles& particles, std::vector<Body>& bodies);

}  // namespace deforma
