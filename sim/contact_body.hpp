#pragma once

#include <vector>

#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// What contact knows about one body: the springs of its surface vertices and how far these can have moved.
///
/// The springs are as stiff as a time step allows that is known beforehand. With S = `stiffness` and the
/// body's wave speed c = sqrt(modulus / density) over its spacing d, each vertex has k_s = A_s min_i(w^2 /
/// r_i), w^2 = S (c/d)^2, over the particles i that move it, r_i being the row sums that springs of 1 N/m per
/// m^2 would give: no particle then feels a squared frequency above w^2. On a flat side that is about k_s = S
/// (lambda + 2 mu) A_s / d. A body without elastic particles takes c = 40 m/s, for an impact at 10 m/s to
/// stay within a quarter of a spacing.
class ContactBody {
 public:
  /// @throws std::invalid_argument when the body has no surface.
  ContactBody(const State& state, Index body, double stiffness);

  Index body() const { return body_; }
  Range vertices() const { return vertices_; }
  double spacing() const { return spacing_; }      ///< d [m]
  bool elastic() const { return elastic_; }        ///< has a modulus of its own
  double frequency() const { return frequency_; }  ///< w, the highest of its contact springs [rad/s]
  double stiffness(Index vertex) const { return stiffness_[vertex - vertices_.begin]; }  ///< k_s [N/m]
  double per_area() const { return per_area_; }            ///< sum k_s / sum A_s [N/m^3]
  double weakest_limit() const { return weakest_limit_; }  ///< what one spring anywhere on it may have [N/m]

  /// Takes the present place as the one to measure from.
  void remember(const State& state);
  /// No vertex is farther than this from where it was [m].
  double moved(const State& state) const;
  /// No vertex is faster [m/s].
  double speed(const State& state) const;

  std::size_t bytes() const;

 private:
  Index body_;
  Range vertices_, particles_;
  double spacing_;
  bool elastic_;
  double frequency_;
  double per_area_ = 0.0;
  double weakest_limit_ = 0.0;
  double gain_ = 1.0;  // of the vertices over the particles
  std::vector<double> stiffness_;
  std::vector<Vec3> remembered_;
};

}  // namespace deforma
