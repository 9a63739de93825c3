#pragma once

#include <vector>

#include "sim/state.hpp"
#include "sim/types.hpp"

namespace deforma {

/// What contact knows about one body: the springs of its surface vertices and how far these can have moved.
///
/// The springs are as stiff as a time step allows that is known beforehand: with S = `stiffness` and the body's wave
/// speed c = sqrt(modulus / density) over its spacing d, their highest frequency is w = sqrt(S) c/d. They are shared out
/// so that every particle near the surface has about the same, k_s = A_s K / r_s: r_s is what springs of 1 N/m per m^2
/// would give to the particles that move the vertex, and K makes w what it should be. A flat side has then about
/// S (lambda + 2 mu) / 2d per area. A body without elastic particles takes c = 40 m/s, for an impact at 10 m/s to stay
/// within a quarter of a spacing.
class ContactBody {
 public:
  /// @throws std::invalid_argument when the body has no surface.
  ContactBody(const State& state, Index body, double stiffness);

  Index body() const { return body_; }
  Range vertices() const { return vertices_; }
  double spacing() const { return spacing_; }      ///< d [m]
  bool elastic() const { return elastic_; }        ///< has a modulus of its own
  double frequency() const { return frequency_; }  ///< w, of all its contact springs at once [rad/s]
  double stiffness(Index vertex) const { return stiffness_[vertex - vertices_.begin]; }  ///< k_s [N/m]
  double per_area() const { return per_area_; }            ///< sum k_s / sum A_s [N/m^3]
  double weakest_limit() const { return weakest_limit_; }  ///< what one spring anywhere on it may have [N/m]

  /// Takes the present place as the one to measure from.
  void remember(const State& state);
  /// No vertex is farther than this from where it was [m].
  double moved(const State& state) const;
  /// Of the fastest particle [m/s].
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
