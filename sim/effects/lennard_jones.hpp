#pragma once

#include "sim/effects/registry.hpp"

namespace deforma {

/// Lennard-Jones forces (paper eq 20, as an energy) between particles of different bodies, and within a body
/// on request:
///     V(r) = 4 beta ((alpha/r)^12 - (alpha/r)^6), cut and shifted to zero at 2.5 alpha,
/// alpha and beta being the means of the two bodies'. Below 0.8 alpha the energy goes on along its tangent,
/// so that the force stays finite; at distance zero the particle of lower index is pushed along +x. Pairs of
/// one body that are within the cut at rest are left out: they would strain the rest shape.
const EffectInfo& lennard_jones_effect();

/// The potential of one pair, without unit: r in alpha, energy in beta.
struct LennardJonesPotential {
  static constexpr double cut = 2.5;
  static constexpr double cap = 0.8;

  static double energy(double r);     ///< V
  static double slope(double r);      ///< V'
  static double curvature(double r);  ///< V'', at the cap's for what lies below it
};

}  // namespace deforma
