#pragma once

#include <algorithm>
#include <cmath>

#include "sim/contact_body.hpp"
#include "sim/curve.hpp"

namespace deforma {

/// One body's contact table, and the body.
struct ContactProperties {
  // For a free particle's bounce to keep its energy, a part of the stable step.
  static constexpr double resolved = 0.04;

  ContactBody body;
  Curve<double> friction, restitution, young;
  double young_then;        ///< when the springs were measured [Pa]
  bool paired = false;      ///< something besides obstacles can be touched
  double softening = 1.0;   ///< of the springs: Young's modulus now over then
  double stiffening = 1.0;  ///< of the deepest touch: E'' over k

  /// How wide restitution is blended, in the velocity that a touch as deep would have come with: about one
  /// step of the motion it damps.
  double blend() const { return body.elastic() ? 1.5 : 0.05; }
  void move_to(double time) {  // [s]
    if (young_then > 0.0) softening = young.at(time) / young_then;
  }
  double frequency() const { return body.frequency() * std::sqrt(softening); }
  /// [s]; the springs of two bodies act on the relative motion: at most twice as stiff for each.
  double stable_step() const {
    const double step = 2.0 / (frequency() * std::sqrt((paired ? 2.0 : 1.0) * stiffening));
    return body.elastic() ? step : resolved * step;
  }
};

/// The stiffness [N/m] with which a vertex of one body, its own spring being `stiffness`, keeps out of another body: both
/// bodies' vertices act, half each, and no stiffer than what the softer one can take.
inline double pair_stiffness(const ContactProperties& side, double stiffness,
                             const ContactProperties& other) {
  const double own = side.softening * side.body.per_area(), others = other.softening * other.body.per_area();
  return 0.5 *
         std::min(stiffness * std::min(1.0, others / own), other.softening * other.body.weakest_limit());
}

}  // namespace deforma
