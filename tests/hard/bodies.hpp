#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "sim/effects/registry.hpp"
#include "sim/solver.hpp"
#include "tests/sim/fixtures.hpp"
#include "tests/sim/gradient_check.hpp"

/// The bodies of the hard cases, and what is asked of them.
namespace deforma::hard {

constexpr double young = 1e6;     // Pa
constexpr double poisson = 0.3;   // -
constexpr double density = 1000;  // kg/m^3
constexpr double spacing = 0.1;   // m
constexpr Gradient both_fits[] = {Gradient::linear, Gradient::quadratic};

/// What suits each fit, as scenes have it.
inline NeighborhoodSettings neighborhood(Gradient gradient) {
  return gradient == Gradient::linear ? NeighborhoodSettings{}
                                      : NeighborhoodSettings{.neighbors = 30, .support = 1.7};
}
inline double hourglass_stiffness(Gradient gradient) { return gradient == Gradient::linear ? 1.0 : 10.0; }

inline void prepare(State& state, Gradient gradient) {
  prepare_state(state, neighborhood(gradient), {}, {}, gradient);
}

/// Wave speed sqrt((lambda + 2 mu) / rho) [m/s].
inline double wave_speed(double E = young, double nu = poisson, double rho = density) {
  return std::sqrt(E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / rho);
}

/// The reference cube of 6^3 particles, not yet prepared.
inline State cube_particles(double jitter = 0.0, double rho = density) {
  return lattice_particles(Vec3::Constant(6 * spacing), 6, 6, 6, rho, jitter);
}
inline State cube(Gradient gradient, double jitter = 0.0) {
  State state = cube_particles(jitter);
  prepare(state, gradient);
  return state;
}

/// Default material and hourglass control of one body.
inline std::vector<EffectRequest> elastic(Gradient gradient, Index body = 0, double E = young,
                                          double nu = poisson, const std::string& material = "neo_hookean") {
  return {
      {"elastic",
       {body, given("elastic",
                    {{"young", Curve<double>(E)}, {"poisson", Curve<double>(nu)}, {"material", material}})}},
      {"hourglass",
       {body, given("hourglass", {{"stiffness", Curve<double>(hourglass_stiffness(gradient))}})}}};
}

inline EffectRequest damping(double rate, Index body = 0) {
  return {"damping", {body, given("damping", {{"rate", Curve<double>(rate)}})}};
}
inline EffectRequest gravity(const Vec3& g, Index body = 0) {
  return {"gravity", {body, given("gravity", {{"acceleration", Curve<Vec3>(g)}})}};
}

inline std::vector<EffectRequest> operator+(std::vector<EffectRequest> requests, EffectRequest further) {
  requests.push_back(std::move(further));
  return requests;
}

inline Solver make_solver(State state, const std::vector<EffectRequest>& requests,
                          const SolverSettings& settings = {}) {
  auto effects = make_effects(state, requests);
  return Solver(std::move(state), std::move(effects), settings);
}

/// Exactly so many substeps, each of the stable step at that moment.
inline void take_steps(Solver& solver, int steps) {
  for (int k = 0; k < steps; ++k) solver.advance(solver.stable_step());
}

/// No NaN and no Inf in any array of the state.
inline bool finite_everywhere(const State& state) {
  const auto finite = [](const auto& field) {
    return std::all_of(field.begin(), field.end(), [](const auto& entry) { return entry.allFinite(); });
  };
  const auto numbers = [](const auto& field) {
    return std::all_of(field.begin(), field.end(), [](double x) { return std::isfinite(x); });
  };
  const Particles& p = state.particles;
  const MovingLeastSquares& fit = state.fit;
  bool links = std::all_of(state.links.links.begin(), state.links.links.end(),
                           [](const Link& link) { return std::isfinite(link.weight); });
  bool pairs = std::all_of(fit.there.begin(), fit.there.end(),
                           [](const GradientLink& link) { return gradient_vector(link).allFinite(); });
  bool ties =
      std::all_of(state.surface.skin.ties.begin(), state.surface.skin.ties.end(),
                  [](const Skin::Tie& tie) { return std::isfinite(tie.weight) && tie.arm.allFinite(); });
  return finite(p.rest) && finite(p.displacement) && finite(p.velocity) && numbers(p.mass) &&
         numbers(p.volume) && numbers(state.links.support) && links && finite(fit.inverse) &&
         finite(fit.projectors) && numbers(fit.trace) && pairs && ties && finite(state.surface.rest) &&
         numbers(state.surface.area) && finite(state.surface.position) && finite(state.surface.velocity) &&
         finite(state.F) && finite(state.F_rate) && std::isfinite(state.time);
}

inline double largest_norm(std::span<const Vec3> field) {
  double largest = 0.0;
  for (const Vec3& v : field) largest = std::max(largest, v.norm());
  return largest;
}

/// Velocities of up to `speed` in each direction, without momentum, always the same.
inline void agitate(State& state, double speed, unsigned seed = 5) {
  std::mt19937 generator(seed);
  Vec3 momentum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      state.particles.velocity[i][axis] = (generator() / 2147483648.0 - 1.0) * speed;
    momentum += state.particles.mass[i] * state.particles.velocity[i];
    mass += state.particles.mass[i];
  }
  for (Vec3& v : state.particles.velocity) v -= momentum / mass;
}

/// A smooth motion without momentum that stretches, bends, shears and twists: up to about `speed` [m/s] on a body of
/// the given size [m]. Energy is kept to a part of a per cent only for motion that the particles resolve.
inline void stir(State& state, double speed, double size) {
  const double k = 3.0 / size;
  Vec3 momentum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3 X = k * state.particles.rest[i];
    state.particles.velocity[i] =
        speed * Vec3(std::cos(X.x()) - 0.3 * std::sin(X.z()), std::sin(0.7 * X.x() + 0.4 * X.y()),
                     std::cos(X.x()) * std::cos(X.y()));
    momentum += state.particles.mass[i] * state.particles.velocity[i];
    mass += state.particles.mass[i];
  }
  for (Vec3& v : state.particles.velocity) v -= momentum / mass;
}

/// How far the mean energy over a tenth of the run ever is from that over the first tenth, relative. Within a step or two
/// the energy at the steps swings about what the integrator keeps, by up to (omega dt)^2/4 of it for the stiffest
/// motion: that is no drift.
inline double energy_drift(Solver& solver, int steps) {
  double first = 0.0, drift = 0.0;
  for (int tenth = 0; tenth < 10; ++tenth) {
    double mean = 0.0;
    const int looks = steps / 10 / 5;
    for (int look = 0; look < looks; ++look) {
      take_steps(solver, 5);
      mean += solver.ledger().total() / looks;
    }
    if (tenth == 0) first = mean;
    drift = std::max(drift, std::abs(mean - first) / first);
  }
  return drift;
}

inline Mat3 random_rotation(std::mt19937& generator) {
  const auto uniform = [&] { return generator() / 2147483648.0 - 1.0; };
  Eigen::Quaterniond q(uniform(), uniform(), uniform(), uniform());
  return q.normalized().toRotationMatrix();
}

inline Vec3 random_direction(std::mt19937& generator) { return random_rotation(generator).col(0); }

/// Turns and moves the rest shape itself.
inline void pose_rest(State& state, const Mat3& rotation, const Vec3& shift = Vec3::Zero()) {
  for (Vec3& X : state.particles.rest) X = rotation * X + shift;
  for (Vec3& X : state.surface.rest) X = rotation * X + shift;
}

/// Displaces every particle to rotation X + shift.
inline void move_rigidly(State& state, const Mat3& rotation, const Vec3& shift = Vec3::Zero()) {
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.displacement[i] = rotation * state.particles.rest[i] + shift - state.particles.rest[i];
}

/// Largest distance of a particle from the closest rigid image (a proper rotation) of the rest shape [m].
inline double deviation_from_rigid(const State& state) {
  const auto n = static_cast<double>(state.size());
  Vec3 rest = Vec3::Zero(), now = Vec3::Zero();
  for (std::size_t i = 0; i < state.size(); ++i)
    rest += state.particles.rest[i] / n, now += state.particles.position(i) / n;
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < state.size(); ++i)
    covariance += (state.particles.position(i) - now) * (state.particles.rest[i] - rest).transpose();
  Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 sign = Mat3::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Mat3 R = svd.matrixU() * sign * svd.matrixV().transpose();
  double largest = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i)
    largest =
        std::max(largest, (state.particles.position(i) - now - R * (state.particles.rest[i] - rest)).norm());
  return largest;
}

}  // namespace deforma::hard
