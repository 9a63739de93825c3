#pragma once

#include <span>
#include <vector>

#include "sim/modes.hpp"
#include "sim/solver.hpp"

// What `deforma validate` reads from a simulated body, the bars lying along x from 0.
namespace deforma {

/// Mean displacement of the surface's face at X = x [m], by area.
/// @throws std::runtime_error when no triangle lies in that plane.
Vec3 face_displacement(const Solver& solver, double x);

/// Mean displacement along x of the surface's vertices at X = x [m].
double ring_displacement(const Solver& solver, double x);

/// Twist per length about the x axis between two sections [rad/m]: the best line through the rotation of all surface
/// vertices from X = begin to end.
double twist_rate(const Solver& solver, double begin, double end);

/// Largest principal Green strain of all particles, by magnitude.
double largest_strain(const State& state);

/// How many particles are solved for.
std::size_t free_particles(const State& state);

/// The parts of a mode's kinetic energy in which whole sections of a bar move.
struct SectionShares {
  double across;  ///< move in y and z
  double along;   ///< move in x
  double twist;   ///< turn about the bar's axis
};

/// @param thickness of a section [m]: the spacing
SectionShares section_shares(const State& state, std::span<const Vec3> shape, double thickness);

/// A sine about a constant, fitted to samples by least squares.
struct Oscillation {
  double period;     ///< [s]
  double mean;       ///< as the values
  double amplitude;  ///< as the values
};

/// @param times [s], @param values as many
/// @param guess of the period [s], found within a factor of two
Oscillation fit_oscillation(std::span<const double> times, std::span<const double> values, double guess);

/// When samples first reach a level, by interpolation [s].
/// @throws std::runtime_error when they never do.
double time_of_level(std::span<const double> times, std::span<const double> values, double level);

}  // namespace deforma
