#include "sim/spring_network.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "sim/parallel.hpp"
#include "sim/rotation.hpp"

namespace deforma {

namespace {

constexpr std::size_t nearest = 6;
constexpr double reach = 1.75;        // of their mean distance
constexpr double slack_limit = 1e-3;  // a direction with less of a particle's stiffness counts as unheld
constexpr double least_hold = 1e-11;  // of its stiffness, that holds a particle of any body
constexpr double free_hold = 1e-2;    // of E / rho L^2, that holds a free body
constexpr double dependent = 1e-3;    // aggregates' motions with less of the largest norm, squared
constexpr Index nobody = std::numeric_limits<Index>::max();

// How far springs of a particle reach [m].
double reach_of(const State& state, std::size_t i, std::vector<double>& distances) {
  distances.clear();
  Range row = state.links.row(i);
  for (Index l = row.begin; l < row.end; ++l)
    distances.push_back((state.particles.rest[state.links.links[l].j] - state.particles.rest[i]).norm());
  std::size_t count = std::min(nearest, distances.size());
  if (count == 0) return 0.0;
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(count - 1),
                   distances.end());
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) sum += distances[k];
  return reach * sum / static_cast<double>(count);
}

// E / rho L^2 of a body, L its rest shape's diagonal [1/s^2].
double slowness(const State& state, const Body& body) {
  double mass = 0.0, volume = 0.0;
  for (Index i = body.particles.begin; i < body.particles.end; ++i) {
    mass += state.particles.mass[i];
    volume += state.particles.volume[i];
  }
  const double length =
      extent(std::span(state.particles.rest).subspan(body.particles.begin, body.particles.size()));
  return length > 0.0 ? body.young.at(state.time) * volume / (mass * length * length) : 0.0;
}

}  // namespace

double extent(std::span<const Vec3> points) {
  if (points.empty()) return 0.0;
  Vec3 low = points.front(), high = low;
  for (const Vec3& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return (high - low).norm();
}

SpringNetwork::SpringNetwork(const State& state) {
  for (const Body& body : state.bodies) hold_.push_back(free_hold * slowness(state, body));
  const std::size_t n = state.size();
  std::vector<double> reaches(n), scratch;
  for (std::size_t i = 0; i < n; ++i) reaches[i] = reach_of(state, i, scratch);
  start_.push_back(0);
  for (std::size_t i = 0; i < n; ++i) {
    const double young = state.bodies[state.particles.body[i]].young.at(state.time);
    Range links = state.links.row(i);
    for (Index l = links.begin; l < links.end && young > 0.0; ++l) {
      const Index j = state.links.links[l].j;
      const double squared = (state.particles.rest[j] - state.particles.rest[i]).squaredNorm();
      if (!(squared > 0.0) || 2.0 * std::sqrt(squared) > reaches[i] + reaches[j]) continue;
      const double volume = 0.5 * (state.particles.volume[i] + state.particles.volume[j]);
      springs_.push_back({j, 0.5 * young * volume / squared, Vec3::Zero(), Vec3::Zero()});
    }
    start_.push_back(static_cast<Index>(springs_.size()));
  }
  aggregate(state);
}

// First every particle whose neighbours are all free gathers them; what is left joins a neighbour's, or its own.
void SpringNetwork::aggregate(const State& state) {
  const std::size_t n = state.size();
  group_.assign(n, nobody);
  for (std::size_t i = 0; i < n; ++i) {
    Range springs = row(i);
    bool all_free = group_[i] == nobody;
    for (Index s = springs.begin; s < springs.end && all_free; ++s)
      all_free = group_[springs_[s].j] == nobody;
    if (!all_free) continue;
    group_[i] = groups_;
    for (Index s = springs.begin; s < springs.end; ++s) group_[springs_[s].j] = groups_;
    ++groups_;
  }
  const std::vector<Index> gathered = group_;
  for (std::size_t i = 0; i < n; ++i) {
    if (group_[i] != nobody) continue;
    double closest = std::numeric_limits<double>::infinity();
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s) {
      const Index j = springs_[s].j;
      const double distance = (state.particles.rest[j] - state.particles.rest[i]).squaredNorm();
      if (gathered[j] == nobody || !(distance < closest)) continue;
      closest = distance;
      group_[i] = gathered[j];
    }
    if (group_[i] == nobody) group_[i] = groups_++;
  }
}

void SpringNetwork::assemble(const State& state, std::span<const Vec3> displacement) {
  const std::size_t n = state.size();
  fixed_ = state.fixed;
  std::vector<double> shift = hold_;
  for (std::size_t i = 0; i < n; ++i)
    if (fixed_[i]) shift[state.particles.body[i]] = 0.0;
  ground_.resize(n);
  inverse_.resize(n);
  parallel_for_each(n, [&](std::size_t i) {
    Mat3 block = Mat3::Zero();
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s) {
      Spring& spring = springs_[s];
      spring.arm =
          state.particles.rest[spring.j] - state.particles.rest[i] + displacement[spring.j] - displacement[i];
      const double length = spring.arm.norm();
      spring.pull = length > 0.0 ? Vec3(std::sqrt(spring.stiffness) / length * spring.arm) : Vec3::Zero();
      block += spring.pull * spring.pull.transpose();
    }
    // A sheet's springs leave its normal free, where only hourglass control acts.
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.computeDirect(block);
    const double largest = eigen.eigenvalues()[2];
    ground_[i] = (shift[state.particles.body[i]] * state.particles.mass[i] +
                  (largest > 0.0 ? least_hold * largest : 1.0)) *
                 Mat3::Identity();
    for (int k = 0; k < 2; ++k)
      if (eigen.eigenvalues()[k] < slack_limit * largest)
        ground_[i] += largest * eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose();
    inverse_[i] = (block + ground_[i]).inverse();
  });
  find_bases(state, displacement);
  factor_coarse();
}

void SpringNetwork::find_bases(const State& state, std::span<const Vec3> displacement) {
  const std::size_t n = state.size();
  std::vector<Vec3> center(groups_, Vec3::Zero());
  std::vector<double> count(groups_, 0.0), squared(groups_, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    center[group_[i]] += state.particles.rest[i] + displacement[i];
    count[group_[i]] += 1.0;
  }
  for (Index g = 0; g < groups_; ++g) center[g] /= count[g];
  for (std::size_t i = 0; i < n; ++i)
    squared[group_[i]] += (state.particles.rest[i] + displacement[i] - center[group_[i]]).squaredNorm();
  basis_.assign(n, Basis::Zero());
  std::vector<Eigen::Matrix<double, 6, 6>> gram(groups_, Eigen::Matrix<double, 6, 6>::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    if (fixed_[i]) continue;
    const Index g = group_[i];
    const double radius = squared[g] > 0.0 ? std::sqrt(squared[g] / count[g]) : 1.0;
    const Vec3 arm = (state.particles.rest[i] + displacement[i] - center[g]) / radius;
    basis_[i].leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) basis_[i].col(3 + axis) = Vec3::Unit(axis).cross(arm);
    gram[g] += basis_[i].transpose() * basis_[i];
  }
  rank_.assign(groups_, 0);
  column_.assign(groups_ + 1, 0);
  std::vector<Eigen::Matrix<double, 6, 6>> transform(groups_, Eigen::Matrix<double, 6, 6>::Zero());
  for (Index g = 0; g < groups_; ++g) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(gram[g]);
    for (int k = 5; k >= 0 && eigen.eigenvalues()[k] > dependent * eigen.eigenvalues()[5]; --k)
      transform[g].col(rank_[g]++) = eigen.eigenvectors().col(k) / std::sqrt(eigen.eigenvalues()[k]);
    column_[g + 1] = column_[g] + static_cast<Index>(rank_[g]);
  }
  for (std::size_t i = 0; i < n; ++i) basis_[i] *= transform[group_[i]];
}

void SpringNetwork::factor_coarse() {
  using Block = Eigen::Matrix<double, 6, 6>;
  using Coordinates = Eigen::Matrix<double, 6, 1>;
  std::vector<std::map<Index, Block>> blocks(groups_);  // row g, column <= g
  auto block = [&](Index g, Index h) -> Block& {
    return blocks[g].try_emplace(h, Block::Zero()).first->second;
  };
  for (std::size_t i = 0; i < group_.size(); ++i) {
    const Index g = group_[i];
    Block own = basis_[i].transpose() * ground_[i] * basis_[i];
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s) {
      const Spring& spring = springs_[s];
      const Index h = group_[spring.j];
      const Coordinates here = basis_[i].transpose() * spring.pull;
      const Coordinates there = basis_[spring.j].transpose() * spring.pull;
      own += here * here.transpose();
      if (g == h)
        own -= here * there.transpose();
      else if (h < g)
        block(g, h) -= here * there.transpose();
    }
    block(g, g) += own;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index g = 0; g < groups_; ++g)
    for (const auto& [h, values] : blocks[g])
      for (int a = 0; a < rank_[g]; ++a)
        for (int b = 0; b < rank_[h]; ++b)
          entries.emplace_back(column_[g] + static_cast<Index>(a), column_[h] + static_cast<Index>(b),
                               values(a, b));
  Eigen::SparseMatrix<double> matrix(column_.back(), column_.back());
  matrix.setFromTriplets(entries.begin(), entries.end());
  coarse_.compute(matrix);
}

void SpringNetwork::solve(std::span<const Vec3> force, std::span<Vec3> answer) const {
  const std::size_t n = fixed_.size();
  // What is left of the force for particle i, its own share of the answer aside.
  auto left = [&](std::size_t i) {
    Vec3 rest = force[i];
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s) {
      const Spring& spring = springs_[s];
      rest += spring.pull.dot(answer[spring.j]) * spring.pull;
    }
    return rest;
  };
  std::fill(answer.begin(), answer.end(), Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i)
    if (!fixed_[i]) answer[i] = inverse_[i] * left(i);
  std::vector<Vec3> residual(n, Vec3::Zero());
  parallel_for_each(n, [&](std::size_t i) {
    if (fixed_[i]) return;
    residual[i] = left(i) - ground_[i] * answer[i];
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s)
      residual[i] -= springs_[s].pull.dot(answer[i]) * springs_[s].pull;
  });
  Eigen::VectorXd coordinates = Eigen::VectorXd::Zero(column_.back());
  for (std::size_t i = 0; i < n; ++i) {
    const Index g = group_[i];
    coordinates.segment(column_[g], rank_[g]).noalias() +=
        (basis_[i].transpose() * residual[i]).head(rank_[g]);
  }
  if (coordinates.size() > 0) coordinates = coarse_.solve(coordinates).eval();
  for (std::size_t i = 0; i < n; ++i) {
    const Index g = group_[i];
    answer[i] += basis_[i].leftCols(rank_[g]) * coordinates.segment(column_[g], rank_[g]);
  }
  for (std::size_t i = n; i-- > 0;)
    if (!fixed_[i]) answer[i] = inverse_[i] * left(i);
}

double SpringNetwork::steepness(std::span<const Vec3> change) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s) {
      const double length = springs_[s].arm.squaredNorm();
      if (length > 0.0)
        largest = std::max(largest, (change[springs_[s].j] - change[i]).squaredNorm() / length);
    }
  }
  return std::sqrt(largest);
}

void SpringNetwork::turn(std::span<Vec3> change) const {
  constexpr double accuracy = 1e-3;
  constexpr int most_iterations = 400;
  const std::size_t n = fixed_.size();
  std::vector<Vec3> spin(n), residual(n, Vec3::Zero()), direction(n, Vec3::Zero()), product(n, Vec3::Zero());
  std::vector<Mat3> rotation(n);
  parallel_for_each(n, [&](std::size_t i) {
    Mat3 inertia = Mat3::Zero();
    Vec3 moment = Vec3::Zero();
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s) {
      const Spring& spring = springs_[s];
      inertia += spring.stiffness *
                 (spring.arm.squaredNorm() * Mat3::Identity() - spring.arm * spring.arm.transpose());
      moment += spring.stiffness * spring.arm.cross(change[spring.j] - change[i]);
    }
    const double trace = inertia.trace();
    spin[i] =
        trace > 0.0 ? Vec3((inertia + 1e-6 * trace * Mat3::Identity()).inverse() * moment) : Vec3::Zero();
    rotation[i] = rotation_matrix(spin[i]);
  });
  // Where the springs then want their ends, less where they are: the residual of a network without directions.
  parallel_for_each(n, [&](std::size_t i) {
    if (fixed_[i]) return;
    Range springs = row(i);
    for (Index s = springs.begin; s < springs.end; ++s) {
      const Spring& spring = springs_[s];
      const Vec3 stretched = spring.arm + change[spring.j] - change[i];
      const Vec3 wanted = 0.5 * (rotation[i] * (stretched - spin[i].cross(spring.arm)) +
                                 rotation[spring.j] * (stretched - spin[spring.j].cross(spring.arm)));
      residual[i] += spring.stiffness * (stretched - wanted);
    }
  });
  std::vector<double> diagonal(n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (Index s = row(i).begin; s < row(i).end; ++s) diagonal[i] += springs_[s].stiffness;
  auto scaled_norm = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      if (diagonal[i] > 0.0) sum += residual[i].squaredNorm() / diagonal[i];
    return sum;
  };
  double size = scaled_norm();
  const double enough = accuracy * accuracy * size;
  double share = 0.0;
  for (int iteration = 0; iteration < most_iterations && size > enough; ++iteration) {
    parallel_for_each(n, [&](std::size_t i) {
      if (diagonal[i] > 0.0) direction[i] = residual[i] / diagonal[i] + share * direction[i];
    });
    parallel_for_each(n, [&](std::size_t i) {
      product[i].setZero();
      if (fixed_[i]) return;
      Range springs = row(i);
      for (Index s = springs.begin; s < springs.end; ++s)
        product[i] += springs_[s].stiffness * (direction[i] - direction[springs_[s].j]);
    });
    double curvature = 0.0;
    for (std::size_t i = 0; i < n; ++i) curvature += direction[i].dot(product[i]);
    if (!(curvature > 0.0)) break;
    for (std::size_t i = 0; i < n; ++i) {
      change[i] += size / curvature * direction[i];
      residual[i] -= size / curvature * product[i];
    }
    const double before = size;
    size = scaled_norm();
    share = size / before;
  }
}

}  // namespace deforma
