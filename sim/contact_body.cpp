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

// A vertex moves by sum_i c_i a_i, sum_i c_i = 1: by the mean of a, and at most the gain times the rest.
template <typename Value>
double vertex_bound(Range particles, double gain, const Value& a) {
  Vec3 mean = Vec3::Zero();
  for (Index i = particles.begin; i < particles.end; ++i) mean += a(i);
  mean /= particles.size();
  double largest = 0.0;
  for (Index i = particles.begin; i < particles.end; ++i)
    largest = std::max(largest, (a(i) - mean).squaredNorm());
  return mean.norm() + gain * std::sqrt(largest);
}

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
  const std::span<const double> areas =
      std::span(state.surface.area).subspan(vertices_.begin, vertices_.size());
  const std::vector<double> unit = squared_frequency_bounds(state, rows, areas);
  weakest_limit_ = std::numeric_limits<double>::infinity();
  for (Index s = vertices_.begin; s < vertices_.end; ++s) {
    const double gain = rows.gain(s);
    gain_ = std::max(gain_, gain);
    double k = std::numeric_limits<double>::infinity();
    for (const auto& [i, c] : rows.row(s)) {
      if (unit[i] > 0.0) k = std::min(k, state.surface.area[s] * allowed / unit[i]);
      if (c != 0.0)
        weakest_limit_ = std::min(weakest_limit_, allowed * state.particles.mass[i] / (std::abs(c) * gain));
    }
    stiffness_.push_back(std::isfinite(k) ? k : 0.0);
    per_area_ += stiffness_.back() / area;
  }
}

void ContactBody::remember(const State& state) {
  remembered_.assign(state.particles.displacement.begin() + particles_.begin,
                     state.particles.displacement.begin() + particles_.end);
}

double ContactBody::moved(const State& state) const {
  return vertex_bound(particles_, gain_, [&](Index i) -> Vec3 {
    return state.particles.displacement[i] - remembered_[i - particles_.begin];
  });
}

double ContactBody::speed(const State& state) const {
  return vertex_bound(particles_, gain_, [&](Index i) -> const Vec3& { return state.particles.velocity[i]; });
}

std::size_t ContactBody::bytes() const {
  return stiffness_.capacity() * sizeof(double) + remembered_.capacity() * sizeof(Vec3);
}

}  // namespace deforma
