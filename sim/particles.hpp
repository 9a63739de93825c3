#pragma once

#include <string>
#include <vector>

#include "sim/curve.hpp"
#include "sim/types.hpp"

namespace deforma {

/// The part of a body that a particle stands for, by its moments about the particle's rest position X_i.
struct Cell {
  Vec3 first = Vec3::Zero();   ///< integral of X - X_i [m^4]
  Mat3 second = Mat3::Zero();  ///< integral of (X - X_i)(X - X_i)^T [m^5]
};

/// The particles of every body, one array per quantity, all of one length n.
///
/// Displacement is stored, not position, so that a body far from the origin keeps its digits.
struct Particles {
  std::vector<Vec3> rest;          ///< X [m]
  std::vector<Vec3> displacement;  ///< u [m]; the current position is X + u
  std::vector<Vec3> velocity;      ///< v [m/s]
  std::vector<double> mass;        ///< m [kg]
  std::vector<double> volume;      ///< V of its cell at rest [m^3]
  std::vector<Cell> cells;         ///< beside the volumes, or empty where nothing is known of them
  std::vector<Index> body;         ///< which body it belongs to

  std::size_t size() const { return rest.size(); }
  Vec3 position(std::size_t i) const { return rest[i] + displacement[i]; }
};

/// A body's share of the world's arrays.
struct Body {
  std::string name;
  Range particles;
  Range vertices;        ///< of the surface
  Range triangles;       ///< of the surface
  double spacing = 0.0;  ///< d = (V/N)^(1/3) [m]
  // Of its elastic material, which writes them for the effects that scale with it; 0 without one.
  double modulus = 0.0;       ///< P-wave modulus lambda + 2 mu at the start [Pa]
  Curve<double> young = 0.0;  ///< Young's modulus over time [Pa]
};

}  // namespace deforma
