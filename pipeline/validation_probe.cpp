#include "pipeline/validation_probe.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace deforma {

namespace {

constexpr double in_plane = 1e-6;  // of the body's size

std::vector<Vec3> surface_displacement(const Solver& solver) {
  const Surface& surface = solver.state().surface;
  std::vector<Vec3> moved(surface.size());
  solver.deform(moved);
  for (std::size_t s = 0; s < moved.size(); ++s) moved[s] -= surface.rest[s];
  return moved;
}

double tolerance_of(const Surface& surface) {
  double largest = 0.0;
  for (const Vec3& point : surface.rest) largest = std::max(largest, point.cwiseAbs().maxCoeff());
  return in_plane * largest;
}

[[noreturn]] void refuse_plane(double x) {
  throw std::runtime_error(fmt::format("the surface has nothing at X = {} m", x));
}

}  // namespace

Vec3 face_displacement(const Solver& solver, double x) {
  const Surface& surface = solver.state().surface;
  const std::vector<Vec3> u = surface_displacement(solver);
  const double tolerance = tolerance_of(surface);
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (const Triangle& t : surface.triangles) {
    bool here = true;
    for (Index corner : t) here = here && std::abs(surface.rest[corner].x() - x) <= tolerance;
    if (!here) continue;
    const Vec3 &a = surface.rest[t[0]], &b = surface.rest[t[1]], &c = surface.rest[t[2]];
    double part = 0.5 * (b - a).cross(c - a).norm();
    sum += part / 3.0 * (u[t[0]] + u[t[1]] + u[t[2]]);
    area += part;
  }
  if (!(area > 0.0)) refuse_plane(x);
  return sum / area;
}

double ring_displacement(const Solver& solver, double x) {
  const State& state = solver.state();
  const double tolerance = tolerance_of(state.surface);
  double sum = 0.0;
  int count = 0;
  for (std::size_t s = 0; s < state.surface.size(); ++s) {
    if (std::abs(state.surface.rest[s].x() - x) > tolerance) continue;
    Vec3 point = skinned_point(state.surface.skin, s, state.surface.rest[s], state.particles.displacement,
                               state.F, state.fit);
    sum += point.x() - state.surface.rest[s].x();
    ++count;
  }
  if (count == 0) refuse_plane(x);
  return sum / count;
}

double twist_rate(const Solver& solver, double begin, double end) {
  const Surface& surface = solver.state().surface;
  const std::vector<Vec3> u = surface_displacement(solver);
  const double tolerance = tolerance_of(surface);
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t s = 0; s < surface.size(); ++s) {
    const Vec3& X = surface.rest[s];
    if (X.x() < begin - tolerance || X.x() > end + tolerance) continue;
    double arm = X.y() * X.y() + X.z() * X.z();  // the square, which weighs the rotation, too
    Eigen::Vector2d line(1.0, X.x() - begin);
    normal += arm * line * line.transpose();
    right += (X.y() * u[s].z() - X.z() * u[s].y()) * line;
  }
  return normal.ldlt().solve(right)[1];
}

double largest_strain(const State& state) {
  double largest = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    Mat3 strain = 0.5 * (state.F[i].transpose() * state.F[i] - state.fit.projector(i));
    Eigen::SelfAdjointEigenSolver<Mat3> eigen(strain, Eigen::EigenvaluesOnly);
    largest = std::max(largest, eigen.eigenvalues().cwiseAbs().maxCoeff());
  }
  return largest;
}

std::size_t free_particles(const State& state) {
  return static_cast<std::size_t>(std::count(state.fixed.begin(), state.fixed.end(), 0));
}

SectionShares section_shares(const State& state, std::span<const Vec3> shape, double thickness) {
  struct Section {
    double mass = 0.0, inertia = 0.0, spin = 0.0;
    Vec3 momentum = Vec3::Zero();
  };
  std::map<long, Section> sections;
  double all = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3& X = state.particles.rest[i];
    double m = state.particles.mass[i];
    Section& section = sections[std::lround(std::floor(X.x() / thickness))];
    section.mass += m;
    section.momentum += m * shape[i];
    section.inertia += m * (X.y() * X.y() + X.z() * X.z());
    section.spin += m * (X.y() * shape[i].z() - X.z() * shape[i].y());
    all += m * shape[i].squaredNorm();
  }
  SectionShares shares{0.0, 0.0, 0.0};
  for (const auto& [at, section] : sections) {
    const Vec3& p = section.momentum;
    shares.across += (p.y() * p.y() + p.z() * p.z()) / section.mass / all;
    shares.along += p.x() * p.x() / section.mass / all;
    if (section.inertia > 0.0) shares.twist += section.spin * section.spin / section.inertia / all;
  }
  return shares;
}

namespace {

struct SineFit {
  double residual;
  Eigen::Vector3d coefficients;  // of 1, cos, sin
};

SineFit fit_sine(std::span<const double> times, std::span<const double> values, double period) {
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  double square = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    double phase = 2.0 * std::numbers::pi * times[k] / period;
    Vec3 terms(1.0, std::cos(phase), std::sin(phase));
    normal += terms * terms.transpose();
    right += values[k] * terms;
    square += values[k] * values[k];
  }
  Vec3 x = normal.ldlt().solve(right);
  return {square - right.dot(x), x};
}

}  // namespace

Oscillation fit_oscillation(std::span<const double> times, std::span<const double> values, double guess) {
  // A scan finds the right valley, narrowing scans its bottom.
  double period = guess, width = guess;  // first from half the guess to twice
  constexpr int steps = 200;
  double low = 0.5 * guess, high = 2.0 * guess;
  for (int round = 0; round < 5; ++round) {
    double best = std::numeric_limits<double>::infinity();
    width = (high - low) / steps;
    for (int k = 0; k <= steps; ++k) {
      double candidate = low + k * width;
      double residual = fit_sine(times, values, candidate).residual;
      if (residual < best) {
        best = residual;
        period = candidate;
      }
    }
    low = period - width;
    high = period + width;
  }
  SineFit fit = fit_sine(times, values, period);
  return {period, fit.coefficients[0], fit.coefficients.tail<2>().norm()};
}

double time_of_level(std::span<const double> times, std::span<const double> values, double level) {
  for (std::size_t k = 1; k < times.size(); ++k)
    if (values[k - 1] < level && values[k] >= level)
      return times[k - 1] + (level - values[k - 1]) / (values[k] - values[k - 1]) * (times[k] - times[k - 1]);
  throw std::runtime_error(fmt::format("the samples never reach {}", level));
}

}  // namespace deforma
