#include "pipeline/reference_loop.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>

#include "sim/material.hpp"

namespace deforma {

namespace {

const ReferenceKernel& kernel_for(ReferenceLoop::Code code) {
  if (code == ReferenceLoop::Code::eigen) return reference_kernel_eigen;
#ifdef __x86_64__
  if (code == ReferenceLoop::Code::best && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    return reference_kernel_avx2;
#endif
  return reference_kernel_portable;
}

std::vector<double> flat(std::span<const Vec3> vectors) {
  std::vector<double> numbers;
  numbers.reserve(3 * vectors.size());
  for (const Vec3& v : vectors) numbers.insert(numbers.end(), v.begin(), v.end());
  return numbers;
}

}  // namespace

ReferenceLoop::ReferenceLoop(const State& state, const ReferenceMaterial& material)
    : start_(state.links.start),
      rest_(flat(state.particles.rest)),
      mass_(state.particles.mass),
      weight_(state.fit.weight),
      u_(flat(state.particles.displacement)),
      v_(flat(state.particles.velocity)) {
  link(state, material);
  const std::size_t n = state.size();
  gradient_.resize(9 * n);
  carried_.resize(9 * n);
  force_.resize(3 * n);
  const auto [lambda, mu] = lame_constants(material.young, material.poisson);
  const ReferenceResidual residual = c_.empty()              ? ReferenceResidual::none
                                     : state.fit.quadratic() ? ReferenceResidual::trapezoid
                                                             : ReferenceResidual::own_fit;
  arrays_ = {n,
             start_.data(),
             j_.data(),
             g_.data(),
             c_.data(),
             residual,
             rest_.data(),
             mass_.data(),
             weight_.data(),
             lambda,
             mu,
             u_.data(),
             v_.data(),
             gradient_.data(),
             carried_.data(),
             force_.data()};
}

void ReferenceLoop::link(const State& state, const ReferenceMaterial& material) {
  const std::size_t n = state.size(), links = state.links.links.size();
  auto offset = [&](std::size_t i, const Link& link) -> Vec3 {
    return state.particles.rest[link.j] - state.particles.rest[i];
  };
  std::vector<Mat3> A(n, Mat3::Zero());
  std::vector<double> stiffness(n);  // c_ij = stiffness_i W_ij
  for (std::size_t i = 0; i < n; ++i) {
    if (state.fit.rank[i] != 3)
      throw std::invalid_argument(fmt::format("the neighbours of particle {} do not span space", i));
    const Range row = state.links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = state.links.links[l];
      A[i] += link.weight * offset(i, link) * offset(i, link).transpose();  // eq 6
    }
    stiffness[i] = material.hourglass * material.young * state.particles.volume[i] / A[i].trace();
  }
  j_.reserve(links);
  g_.reserve(3 * links);
  if (material.hourglass > 0.0) c_.reserve(links);
  for (std::size_t i = 0; i < n; ++i) {
    const Mat3 inverse = A[i].inverse();
    const Range row = state.links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = state.links.links[l];
      const Vec3 g = state.fit.quadratic() ? Vec3(gradient_vector(state.fit.there[l]))
                                           : Vec3(link.weight * (inverse * offset(i, link)));  // eq 7
      j_.push_back(link.j);
      g_.insert(g_.end(), g.begin(), g.end());
      if (material.hourglass > 0.0)
        c_.push_back((stiffness[i] + (state.fit.quadratic() ? stiffness[link.j] : 0.0)) * link.weight);
    }
  }
}

void ReferenceLoop::find_force(std::span<const Vec3> displacement, std::span<Vec3> force, Code code) {
  if (displacement.size() != mass_.size() || force.size() != mass_.size())
    throw std::invalid_argument(fmt::format("{} particles but {} displacements and {} forces", mass_.size(),
                                            displacement.size(), force.size()));
  u_ = flat(displacement);
  arrays_.u = u_.data();
  kernel_for(code).find_force(arrays_);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = Vec3(&force_[3 * i]);
}

void ReferenceLoop::advance(int steps, double dt, Code code) {
  const ReferenceKernel& kernel = kernel_for(code);
  for (int step = 0; step < steps; ++step) {
    kernel.find_force(arrays_);
    kernel.integrate(arrays_, dt);
  }
}

std::vector<Vec3> ReferenceLoop::displacement() const {
  std::vector<Vec3> u(mass_.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = Vec3(&u_[3 * i]);
  return u;
}

std::size_t ReferenceLoop::bytes_per_step() const {
  constexpr std::size_t number = sizeof(double), vector = 3 * number, matrix = 9 * number,
                        index = sizeof(std::uint32_t);
  std::size_t per_link = 2 * (vector + index);
  std::size_t per_particle = index + vector + number + 2 * matrix  // u and weight to grad u and stress
                             + vector                              // the force cleared
                             + index + matrix + 2 * vector         // stress to force
                             + number + 5 * vector;  // force and mass to v and u, both read and written
  if (arrays_.residual == ReferenceResidual::own_fit) {
    per_link += number;
    per_particle += matrix + 2 * vector;  // grad u, u, X
  } else if (arrays_.residual == ReferenceResidual::trapezoid) {
    per_link += index + number;
    per_particle +=
        index + 3 * matrix + 4 * vector;  // grad u, u, X to force and stress, both read and written
  }
  return j_.size() * per_link + mass_.size() * per_particle;
}

}  // namespace deforma
