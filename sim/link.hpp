#pragma once

#include <cstdint>

namespace deforma {

/// One direction of a link: the particle it points to, and the dimensionless weight W(q), rounded once to single
/// precision. Everything is made with that same rounded weight and with the rest positions in double precision, so that
/// linear fields, momentum and torque stay exact to double; eight bytes a link are what a substep reads most of.
struct Link {
  std::uint32_t j;
  float weight;
};

/// One direction of a link of the quadratic fit: its gradient vector g [1/m], and the link itself.
struct GradientLink {
  double g[3];
  Link link;
};
static_assert(sizeof(Link) == 8 && sizeof(GradientLink) == 32);

/// Some particles that rows a little further on will gather from, and none just above has.
struct Ahead {
  std::uint32_t j[4];
};

/// A particle's rest position X [m], padded to a vector register.
struct alignas(32) Place {
  double X[4];
};

/// What a particle's neighbours gather from it, in two cache lines.
struct alignas(64) Carrier {
  double head[4];
  double line[3][4];
};

}  // namespace deforma
