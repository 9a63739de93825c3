#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/solver.hpp"

namespace deforma {

/// A body with what acts on it, from which any number of equal solvers can be made.
struct Specimen {
  State state;
  std::vector<EffectRequest> requests;

  /// A box at the origin, its particles' neighbours as suit the gradient.
  Specimen(Gradient gradient, const Vec3& size, int nx, int ny, int nz, double density, double jitter = 0.0,
           double young = 1e6, double poisson = 0.3) {
    const bool quadratic = gradient == Gradient::quadratic;
    NeighborhoodSettings settings;
    settings.neighbors = quadratic ? 30 : 18;
    settings.support = quadratic ? 1.7 : 1.5;
    state = lattice_box(size, nx, ny, nz, density, jitter, settings, gradient);
    add("elastic", {{"young", Curve<double>(young)}, {"poisson", Curve<double>(poisson)}});
    add("hourglass", {{"stiffness", Curve<double>(quadratic ? 10.0 : 1.0)}});
  }

  void add(std::string_view effect, std::vector<std::pair<std::string_view, SettingValue>> values = {}) {
    requests.push_back({effect, {0, given(effect, std::move(values))}});
  }
  void pin_below(double x) { add("pin", {{"region", Region{.max = Vec3(x, 1e3, 1e3)}}}); }
  void load_end(double length, const Vec3& force) {
    add("load", {{"force", Curve<Vec3>(force)}, {"region", Region{.min = Vec3(length - 1e-9, -1e3, -1e3)}}});
  }

  Solver solver() const {
    State copy = state;
    auto effects = make_effects(copy, requests);
    return Solver(std::move(copy), std::move(effects), {});
  }
};

/// The force at some displacements by the effects themselves, without a solver, zero where `fixed`.
inline std::vector<Vec3> force_without_solver(const Specimen& specimen, std::span<const Vec3> displacement,
                                              const std::vector<std::uint8_t>& fixed) {
  State state = specimen.state;
  auto effects = make_effects(state, specimen.requests);
  state.particles.displacement.assign(displacement.begin(), displacement.end());
  std::vector<Vec3> force = total_force(state, effects);
  for (std::size_t i = 0; i < force.size(); ++i)
    if (fixed[i]) force[i].setZero();
  return force;
}

/// The stiffness of the free degrees of freedom there, by central differences of that force.
inline Eigen::MatrixXd dense_stiffness(const Specimen& specimen, std::vector<Vec3> displacement,
                                       const std::vector<std::uint8_t>& fixed) {
  const auto n = static_cast<Eigen::Index>(3 * displacement.size());
  const double step = 1e-5 * specimen.state.bodies[0].spacing;
  Eigen::MatrixXd stiffness(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    double& u = displacement[static_cast<std::size_t>(k / 3)][k % 3];
    const double before = u;
    u = before + step;
    auto ahead = force_without_solver(specimen, displacement, fixed);
    u = before - step;
    auto behind = force_without_solver(specimen, displacement, fixed);
    u = before;
    for (Eigen::Index i = 0; i < n; ++i)
      stiffness(i, k) =
          (behind[static_cast<std::size_t>(i / 3)][i % 3] - ahead[static_cast<std::size_t>(i / 3)][i % 3]) /
          (2.0 * step);
  }
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < n; ++k)
    if (!fixed[static_cast<std::size_t>(k / 3)]) free.push_back(k);
  return stiffness(free, free);
}

/// A field's entries at the free particles, as `dense_stiffness` orders them.
inline Eigen::VectorXd free_entries(std::span<const Vec3> field, const std::vector<std::uint8_t>& fixed) {
  std::vector<double> entries;
  for (std::size_t i = 0; i < field.size(); ++i)
    if (!fixed[i]) entries.insert(entries.end(), field[i].begin(), field[i].end());
  return Eigen::Map<Eigen::VectorXd>(entries.data(), static_cast<Eigen::Index>(entries.size()));
}

inline std::string name_of(const testing::TestParamInfo<Gradient>& info) {
  return std::string(gradient_name(info.param));
}

/// The message of what `call` refuses.
template <typename Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace deforma
