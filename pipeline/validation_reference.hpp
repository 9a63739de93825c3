#pragma once

// Closed formulas that `deforma validate` compares with. A square bar throughout, width a, Young's modulus E, Poisson's
// ratio nu.
namespace deforma::reference {

/// Timoshenko's shear factor of a rectangle, 10 (1 + nu) / (12 + 11 nu). Cowper, J. Appl. Mech. 33 (1966).
double shear_factor(double poisson);

/// Tip deflection of a clamped bar under a force at its end, P L^3 / 3EI + P L / kappa G A [m].
double end_loaded_tip(double force, double length, double width, double young, double poisson);

/// Tip deflection of a clamped bar under its weight w per length, w L^4 / 8EI + w L^2 / 2 kappa G A [m].
double sag_under_weight(double weight_per_length, double length, double width, double young, double poisson);

/// Torsion constant of a square over a^4: 1/3 (1 - 192/pi^5 sum over odd k of tanh(k pi/2) / k^5) = 0.1406. Timoshenko and
/// Goodier, Theory of Elasticity, section 109.
double square_torsion_constant();

/// Tip deflection over length, v/L, of an inextensible clamped beam under a dead end load, for P L^2 / EI. The elastica,
/// theta'' = -(P/EI) cos theta, by shooting; Bisshopp and Drucker, Quart. Appl. Math. 3 (1945).
/// @param load P L^2 / EI in (0, 20]
double elastica_tip(double load);

}  // namespace deforma::reference
