#pragma once

#include "sim/neighborhood.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Gives a body's particles the masses and volumes that the paper gives them (eq 10 and the text after eq 15):
///     m_i = r_i^3 rho,   rho_i = sum_j m_j W_ij (j = i included),   V_i = m_i / rho_i,
/// with r_i the mean distance of the k nearest and the factor s of eq 10, which is not printed, taken as 1. The masses do
/// not add up to the body's, since r_i grows towards the surface: it is here to be compared with. The fit must be made
/// anew afterwards (`refit`), since it weighs with volumes.
/// @param state    prepared with `settings`; mass and volume are written
/// @param density  rho of the material [kg/m^3]
void give_paper_masses(State& state, Index body, double density, const NeighborhoodSettings& settings);

}  // namespace deforma
