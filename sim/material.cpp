#include "sim/material.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <array>
#include <stdexcept>

namespace deforma {

namespace {

constexpr std::array<std::string_view, 3> names = {"neo_hookean", "st_venant_kirchhoff", "corotated"};

// Lamé's first constant for a membrane (plane stress) or a rope (only axial stress).
double reduced_lambda(const Lame& lame, int rank) {
  double young = lame.mu * (3.0 * lame.lambda + 2.0 * lame.mu) / (lame.lambda + lame.mu);
  return rank == 2 ? 2.0 * lame.lambda * lame.mu / lame.p_wave_modulus() : young - 2.0 * lame.mu;
}

}  // namespace

Material material_from_name(std::string_view name) {
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return static_cast<Material>(k);
  throw std::invalid_argument(
      fmt::format("unknown material '{}' (allowed: {})", name, fmt::join(names, ", ")));
}

std::span<const std::string_view> material_names() { return names; }

Lame lame_constants(double young, double poisson) {
  return {young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson))};
}

Mat3 nearest_rotation(const Mat3& F) {
  Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;  // singular values are sorted
  return U * svd.matrixV().transpose();
}

double energy_density(Material material, const Lame& lame, const Mat3& F) {
  const auto [lambda, mu] = lame;
  switch (material) {
    case Material::neo_hookean: {
      double volume_change = F.determinant() - 1.0;
      return 0.5 * mu * (F.squaredNorm() - 3.0) - mu * volume_change +
             0.5 * (lambda + mu) * volume_change * volume_change;
    }
    case Material::st_venant_kirchhoff: {
      Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
      return 0.5 * lambda * E.trace() * E.trace() + mu * E.squaredNorm();
    }
    case Material::corotated: {
      double volume_change = F.determinant() - 1.0;
      return mu * (F - nearest_rotation(F)).squaredNorm() + 0.5 * lambda * volume_change * volume_change;
    }
  }
  throw std::invalid_argument("unknown material");
}

namespace {

Mat3 neo_hookean_stress(const Lame& lame, const Mat3& F) {
  const Mat3 C = cofactor(F);
  const double J = F.col(0).dot(C.col(0));
  return lame.mu * F + ((lame.lambda + lame.mu) * (J - 1.0) - lame.mu) * C;
}

Mat3 st_venant_kirchhoff_stress(const Lame& lame, const Mat3& F) {
  const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());                    // eq 4
  const Mat3 S = lame.lambda * E.trace() * Mat3::Identity() + 2.0 * lame.mu * E;  // eq 5
  return F * S;
}

Mat3 corotated_stress(const Lame& lame, const Mat3& F) {
  return 2.0 * lame.mu * (F - nearest_rotation(F)) + lame.lambda * (F.determinant() - 1.0) * cofactor(F);
}

}  // namespace

void add_first_piola_kirchhoff(Material material, const Lame& lame, std::span<const Mat3> F,
                               std::span<Mat3> P, const InnerLoops& loops) {
  if (F.empty()) return;
  const auto add = [&](const auto& stress) {
    for (std::size_t k = 0; k < F.size(); ++k) P[k] += stress(lame, F[k]);
  };
  switch (material) {
    case Material::neo_hookean:
      return loops.neo_hookean(lame.lambda, lame.mu, F.data()->data(), F.size(), P.data()->data());
    case Material::st_venant_kirchhoff:
      return add([](const Lame& l, const Mat3& f) { return st_venant_kirchhoff_stress(l, f); });
    case Material::corotated:
      return add([](const Lame& l, const Mat3& f) { return corotated_stress(l, f); });
  }
  throw std::invalid_argument("unknown material");
}

Mat3 first_piola_kirchhoff(Material material, const Lame& lame, const Mat3& F) {
  switch (material) {
    case Material::neo_hookean:
      return neo_hookean_stress(lame, F);
    case Material::st_venant_kirchhoff:
      return st_venant_kirchhoff_stress(lame, F);
    case Material::corotated:
      return corotated_stress(lame, F);
  }
  throw std::invalid_argument("unknown material");
}

double reduced_energy_density(const Lame& lame, const Mat3& F, const Mat3& Q, int rank) {
  if (rank == 0) return 0.0;
  Mat3 E = 0.5 * (F.transpose() * F - Q);
  return 0.5 * reduced_lambda(lame, rank) * E.trace() * E.trace() + lame.mu * E.squaredNorm();
}

Mat3 reduced_first_piola_kirchhoff(const Lame& lame, const Mat3& F, const Mat3& Q, int rank) {
  if (rank == 0) return Mat3::Zero();
  Mat3 E = 0.5 * (F.transpose() * F - Q);
  return F * (reduced_lambda(lame, rank) * E.trace() * Q + 2.0 * lame.mu * E);
}

}  // namespace deforma
