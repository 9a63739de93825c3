#include "sim/contact_body.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim/surface_rows.hpp"

namespace deforma {
namespace {

constexpr double free_wave_speed = 40.0;  // m/s, of bodies without elastic particles

double wave_speed(const State& state, const Body& body) {
  if (!(body.modulus > 0.0)) return free_wave_speed;
  double mass = 0.0, volume = 0.0;
  for (Index i = body.particles.begin; i < body.particles.end; ++i) {
    mass += state.particles.mass[i];
    volume += state.particles.volume[i];
  }
  return std::sqrt(body.modulus * volume / mass);
}

}  // namespace

ContactBody::ContactBody(const State& state, Index index, double stiffness)
    : body_(index),
      vertices_(state.bodies[index].vertices),
      particles_(state.bodies[index].particles),
      spacing_(state.bodies[index].spacing),
      elastic_(state.bodies[index].modulus > 0.0) {
  const Body& body = state.bodies[index];
  const double area = [&] {
    double sum = 0.0;
    for (Index s = vertices_.begin; s < vertices_.end; ++s) sum += state.surface.area[s];
    return sum;
  }();
  if (!(area > 0.0))
    throw std::invalid_argument(fmt::format("contact needs a surface, but body '{}' has none", body.name));
  frequency_ = std::sqrt(stiffness) * wave_speed(state, body) / spacing_;
  const double allowed = frequency_ * frequency_;

  const SurfaceRows rows = make_surface_rows(state, vertices_);
  std::vector<double> unit(state.size(), 0.0);
  for (Index s = vertices_.begin; s < vertices_.end; ++s)
    for (const auto& [i, c] : rows.row(s))
      unit[i] += state.surface.area[s] * std::abs(c) / state.particles.mass[i];
  weakest_limit_ = std::numeric_limits<double>::infinity();
  for (Index s = vertices_.begin; s < vertices_.end; ++s) {
    double felt = 0.0, alone = 0.0;
    for (const auto& [i, c] : rows.row(s)) {
      felt += std::abs(c) * unit[i];
      alone += c * c / state.particles.mass[i];
    }
    const double gain = rows.gain(s);
    gain_ = std::max(gain_, gain);
    stiffness_.push_back(state.surface.area[s] > 0.0 ? state.surface.area[s] * gain / felt : 0.0);
    weakest_limit_ = std::min(weakest_limit_, allowed / alone);
  }
  const double scale = allowed / largest_squared_frequency(state, rows, stiffness_);
  for (double& k : stiffness_) {
    k *= scale;
    per_area_ += k / area;
  }
}

void ContactBody::remember(const State& state) {
  remembered_.assign(state.particles.displacement.begin() + particles_.begin,
                     state.particles.displacement.begin() + particles_.end);
}

double ContactBody::moved(const State& state) const {
  // A vertex moves by sum_i c_i a_i, sum_i c_i = 1: by the mean of a, and by at most the gain times what differs from it.
  const auto moved = [&](Index i) -> Vec3 {
    return state.particles.displacement[i] - remembered_[i - particles_.begin];
  };
  Vec3 mean = Vec3::Zero();
  for (Index i = particles_.begin; i < particles_.end; ++i) mean += moved(i);
  mean /= particles_.size();
  double largest = 0.0;
  for (Index i = particles_.begin; i < particles_.end; ++i)
    largest = std::max(largest, (moved(i) - mean).squaredNorm());
  return mean.norm() + gain_ * std::sqrt(largest);
}

double ContactBody::speed(const State& state) const {
  double largest = 0.0;
  for (Index i = particles_.begin; i < particles_.end; ++i)
    largest = std::max(largest, state.particles.velocity[i].squaredNorm());
  return std::sqrt(largest);
}

std::size_t ContactBody::bytes() const {
  return stiffness_.capacity() * sizeof(double) + remembered_.capacity() * sizeof(Vec3);
}

}  // namespace deforma
