#include <Eigen/Dense>

#include "pipeline/reference_kernel.hpp"
#include "sim/material.hpp"

// The same loop in Eigen's 3-vectors and 3x3 matrices, as one writes it down first. Without machine flags, which no
// file that includes Eigen may have; they change its speed by a few per cent.
namespace deforma {

namespace {

auto vector(double* array, std::size_t i) { return Eigen::Map<Vec3>(array + 3 * i); }
auto vector(const double* array, std::size_t i) { return Eigen::Map<const Vec3>(array + 3 * i); }
auto matrix(double* array, std::size_t i) { return Eigen::Map<Mat3>(array + 9 * i); }

void find_stress(const ReferenceArrays& body) {
  for (std::size_t i = 0; i < body.particles; ++i) {
    Mat3 G = Mat3::Zero();
    for (std::uint32_t l = body.start[i]; l < body.start[i + 1]; ++l)
      G += (vector(body.u, body.j[l]) - vector(body.u, i)) * vector(body.g, l).transpose();
    matrix(body.gradient, i) = G;
    matrix(body.carried, i) =
        body.weight[i] *
        first_piola_kirchhoff(Material::neo_hookean, {body.lambda, body.mu}, Mat3::Identity() + G);
  }
}

void add_trapezoid(const ReferenceArrays& body) {
  for (std::size_t i = 0; i < body.particles; ++i) {
    for (std::uint32_t l = body.start[i]; l < body.start[i + 1]; ++l) {
      const std::size_t j = body.j[l];
      const Vec3 X = vector(body.rest, j) - vector(body.rest, i);
      const Vec3 fitted = 0.5 * (matrix(body.gradient, i) + matrix(body.gradient, j)) * X;
      const Vec3 f = body.c[l] * (vector(body.u, j) - vector(body.u, i) - fitted);
      vector(body.force, i) += f;
      matrix(body.carried, i) -= 0.5 * f * X.transpose();
    }
  }
}

void scatter_force(const ReferenceArrays& body) {
  const bool own_residual = body.residual == ReferenceResidual::own_fit;
  for (std::size_t i = 0; i < body.particles; ++i) {
    for (std::uint32_t l = body.start[i]; l < body.start[i + 1]; ++l) {
      const std::size_t j = body.j[l];
      Vec3 f = matrix(body.carried, i) * vector(body.g, l);
      if (own_residual) {
        const Vec3 X = vector(body.rest, j) - vector(body.rest, i);
        f -= body.c[l] * (matrix(body.gradient, i) * X - (vector(body.u, j) - vector(body.u, i)));
      }
      vector(body.force, i) += f;
      vector(body.force, j) -= f;
    }
  }
}

void find_force(const ReferenceArrays& body) {
  find_stress(body);
  Eigen::Map<Eigen::VectorXd>(body.force, 3 * static_cast<Eigen::Index>(body.particles)).setZero();
  if (body.residual == ReferenceResidual::trapezoid) add_trapezoid(body);
  scatter_force(body);
}

void integrate(const ReferenceArrays& body, double dt) {
  for (std::size_t i = 0; i < body.particles; ++i) {
    vector(body.v, i) += dt / body.mass[i] * vector(body.force, i);
    vector(body.u, i) += dt * vector(body.v, i);
  }
}

}  // namespace

const ReferenceKernel reference_kernel_eigen = {find_force, integrate};

}  // namespace deforma
