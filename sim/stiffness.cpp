#include "sim/stiffness.hpp"

#include <algorithm>
#include <cmath>

namespace deforma {

namespace {

constexpr int most_iterations = 60;
constexpr int least_iterations = 6;
constexpr double settled = 2e-3;  // relative change of omega between iterations
// A change since the last measurement that calls for a new one.
constexpr double grown = 1.25;
constexpr double shrunk = 0.65;
constexpr double key_changed = 0.05;
constexpr double relative_nudge = 1e-5;  // of the spacing

// The same irregular field each time: every mode has a share in it, so none is missed by symmetry.
std::vector<Vec3> irregular_field(std::size_t n) {
  std::vector<Vec3> field(n);
  std::uint64_t state = 0x9E3779B97F4A7C15ull;
  auto next = [&state] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5;
  };
  for (Vec3& v : field) {
    double x = next(), y = next(), z = next();
    v = Vec3(x, y, z);
  }
  return field;
}

}  // namespace

bool StiffnessProbe::stale(const Conditions& now) const {
  if (then_.stiffening.size() != now.stiffening.size()) return true;
  for (std::size_t b = 0; b < now.stiffening.size(); ++b)
    if (now.stiffening[b] > grown * then_.stiffening[b] || now.stiffening[b] < shrunk * then_.stiffening[b] ||
        std::abs(now.key[b] - then_.key[b]) >= key_changed)
      return true;
  return false;
}

double StiffnessProbe::measure(std::span<const Vec3> displacement, std::span<const double> mass,
                               std::span<const std::uint8_t> fixed, double scale, const Force& force) {
  std::size_t n = displacement.size();
  // Bodies do not couple, so what the mode holds of the softer ones dies out; each time a little of everything is put
  // back, or one that has since become the stiffest would never be seen.
  std::vector<Vec3> fresh = irregular_field(n);
  if (mode_.size() != n) {
    mode_ = std::move(fresh);
  } else {
    double largest = 0.0;
    for (const Vec3& v : mode_) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    for (std::size_t i = 0; i < n; ++i) mode_[i] += 0.1 * largest * fresh[i];
  }
  std::vector<Vec3> base(n), nudged(n), answer(n);
  force(displacement, base);
  double omega = 0.0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    double largest = 0.0, weighted = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      if (fixed[i]) mode_[i].setZero();
      largest = std::max(largest, mode_[i].cwiseAbs().maxCoeff());
      weighted += mass[i] * mode_[i].squaredNorm();
    }
    if (!(largest > 0.0) || !std::isfinite(largest)) {
      mode_.clear();  // start afresh next time
      return omega;
    }
    double nudge = relative_nudge * scale / largest;
    for (std::size_t i = 0; i < n; ++i) nudged[i] = displacement[i] + nudge * mode_[i];
    force(nudged, answer);
    double weighted_answer = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 acceleration = fixed[i] ? Vec3::Zero() : Vec3((base[i] - answer[i]) / (nudge * mass[i]));
      weighted_answer += mass[i] * acceleration.squaredNorm();
      mode_[i] = acceleration;
    }
    double before = omega;
    omega = std::sqrt(std::sqrt(weighted_answer / weighted));
    if (!(omega > 0.0)) {
      mode_.clear();
      return 0.0;
    }
    for (Vec3& v : mode_) v /= omega * omega;
    if (iteration + 1 >= least_iterations && std::abs(omega - before) < settled * omega) break;
  }
  return omega;
}

}  // namespace deforma
