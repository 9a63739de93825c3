#include "pipeline/reference_loop.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>

#include "sim/material.hpp"

namespace deforma {

namespace {

const ReferenceKernel& kernel_for(ReferenceLoop::Machine machine) {
#ifdef __x86_64__
  if (machine == ReferenceLoop::Machine::best && __builtin_cpu_supports("avx2") &&
      __builtin_cpu_supports("fma"))
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

ReferenceLoop::ReferenceLoop(const State& state, const ReferenceMaterial& material, Machine machine)
    : start_(state.links.start),
      rest_(flat(state.particles.rest)),
      mass_(state.particles.mass),
      weight_(state.fit.weight),
      u_(flat(state.particles.displacement)),
      v_(flat(state.particles.velocity)),
      kernel_(&kernel_for(machine)) {
  if (state.fit.quadratic()) throw std::invalid_argument("the reference loop has the linear fit only");
  const std::size_t n = state.size(), links = state.links.links.size();
  j_.reserve(links);
  g_.reserve(3 * links);
  if (material.hourglass > 0.0) c_.reserve(links);
  for (std::size_t i = 0; i < n; ++i) {
    if (state.fit.rank[i] != 3)
      throw std::invalid_argument(fmt::format("the neighbours of particle {} do not span space", i));
    const Range row = state.links.row(i);
    auto offset = [&](const Link& link) -> Vec3 {
      return state.particles.rest[link.j] - state.particles.rest[i];
    };
    Mat3 A = Mat3::Zero();
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = state.links.links[l];
      A += link.weight * offset(link) * offset(link).transpose();  // eq 6
    }
    const Mat3 inverse = A.inverse();
    const double pair = material.hourglass * material.young * state.particles.volume[i] / A.trace();
    for (Index l = row.begin; l < row.end; ++l) {
      const Link& link = state.links.links[l];
      const Vec3 g = link.weight * (inverse * offset(link));
      j_.push_back(link.j);
      g_.insert(g_.end(), g.begin(), g.end());
      if (material.hourglass > 0.0) c_.push_back(pair * link.weight);
    }
  }
  gradient_.resize(9 * n);
  carried_.resize(9 * n);
  force_.resize(3 * n);
  const Lame lame = lame_constants(material.young, material.poisson);
  arrays_ = {n,
             start_.data(),
             j_.data(),
             g_.data(),
             c_.empty() ? nullptr : c_.data(),
             rest_.data(),
             mass_.data(),
             weight_.data(),
             lame.lambda,
             lame.mu,
             u_.data(),
             v_.data(),
             gradient_.data(),
             carried_.data(),
             force_.data()};
}

void ReferenceLoop::find_force(std::span<const Vec3> displacement, std::span<Vec3> force) {
  if (displacement.size() != mass_.size() || force.size() != mass_.size())
    throw std::invalid_argument(fmt::format("{} particles but {} displacements and {} forces", mass_.size(),
                                            displacement.size(), force.size()));
  u_ = flat(displacement);
  arrays_.u = u_.data();
  kernel_->find_force(arrays_);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = Vec3(&force_[3 * i]);
}

void ReferenceLoop::advance(int steps, double dt) {
  for (int step = 0; step < steps; ++step) {
    kernel_->find_force(arrays_);
    kernel_->integrate(arrays_, dt);
  }
}

std::vector<Vec3> ReferenceLoop::displacement() const {
  std::vector<Vec3> u(mass_.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = Vec3(&u_[3 * i]);
  return u;
}

std::size_t ReferenceLoop::bytes_per_step() const {
  constexpr std::size_t vector = 3 * sizeof(double), matrix = 9 * sizeof(double);
  const std::size_t links = j_.size(), particles = mass_.size();
  std::size_t per_link = 2 * (vector + sizeof(std::uint32_t));
  // grad u and the stress are written and read, u and the weight read; the force is cleared, and read and written as
  // often as it is gathered; v and u are read and written, the force and the mass read.
  std::size_t per_particle = 2 * sizeof(std::uint32_t) + vector + sizeof(double) + 2 * matrix + 3 * vector +
                             5 * vector + sizeof(double);
  if (!c_.empty()) {
    per_link += sizeof(double);
    per_particle += matrix + 2 * vector;  // grad u, u and X in the second pass
  }
  return links * per_link + particles * per_particle;
}

}  // namespace deforma
