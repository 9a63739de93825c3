#include "sim/neighborhood.hpp"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/parallel.hpp"
#include "sim/point_tree.hpp"

namespace deforma {

namespace {

constexpr double flat = 1e-10;  // moment across, of the largest: a hundred-thousandth of the width

void check(const Particles& particles, const NeighborhoodSettings& settings) {
  if (settings.neighbors < 3)
    throw std::invalid_argument(fmt::format("neighbors must be at least 3, found {}", settings.neighbors));
  if (!(settings.support > 0.0) || !std::isfinite(settings.support))
    throw std::invalid_argument(
        fmt::format("support must be positive and finite, found {}", settings.support));
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (!particles.rest[i].allFinite())
      throw std::invalid_argument(fmt::format("particle {} has a rest position that is not finite", i));
}

// The k nearest of evenly spread points fill a ball; of points in a plane or on a line as many fewer lie within it, and
// the k nearest would reach out much farther. 12 of 30 in a plane, 4 on a line: the same mean distance on a lattice.
std::size_t as_many_as_in_space(int neighbors, int dimensions) {
  const double k = neighbors;
  if (dimensions == 2) return std::max<std::size_t>(3, std::lround(1.25 * std::pow(k, 2.0 / 3.0)));
  if (dimensions == 1) return std::max<std::size_t>(2, std::lround(1.3 * std::cbrt(k)));
  return static_cast<std::size_t>(neighbors);
}

// 1 when all particles of a body lie on a line, 2 in a plane.
int dimensions_of(std::span<const Vec3> rest) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& X : rest) mean += X / static_cast<double>(rest.size());
  Mat3 moment = Mat3::Zero();
  for (const Vec3& X : rest) moment += (X - mean) * (X - mean).transpose();
  const Vec3 extent =
      Eigen::SelfAdjointEigenSolver<Mat3>(moment, Eigen::EigenvaluesOnly).eigenvalues();  // ascending
  return static_cast<int>((extent.array() > flat * extent[2]).count());
}

// h_i = support * mean distance of the k nearest others. A particle without others has no links whatever its
// support.
void find_supports(const PointTree& tree, const Body& body, std::span<const Vec3> rest,
                   const NeighborhoodSettings& settings, std::vector<double>& support) {
  const int dimensions = dimensions_of(rest.subspan(body.particles.begin, body.particles.size()));
  std::size_t k = std::min(as_many_as_in_space(settings.neighbors, dimensions), body.particles.size() - 1ul);
  parallel_for_each(body.particles.size(), [&](std::size_t local) {
    Index i = body.particles.begin + static_cast<Index>(local);
    double sum = 0.0;
    for (const auto& [j, distance] : tree.nearest(rest[i], k + 1)) sum += distance;  // its own adds zero
    double mean = k > 0 ? sum / static_cast<double>(k) : body.spacing;
    support[i] = settings.support * (mean > 0.0 ? mean : 1.0);
  });
}

std::vector<Link> find_row(const PointTree& tree, std::span<const Body> bodies, Index body,
                           std::span<const Vec3> rest, Index i, double widest,
                           std::span<const double> support, Kernel kernel, const LinkFilter& allowed) {
  std::vector<Index> near;
  for (const auto& [local, distance] : tree.within(rest[i], 0.5 * (support[i] + widest))) {
    Index j = bodies[body].particles.begin + local;
    if (j != i && distance < 0.5 * (support[i] + support[j])) near.push_back(j);
  }
  std::sort(near.begin(), near.end());
  std::vector<Link> row;
  for (Index j : near) {
    Vec3 X = rest[j] - rest[i];
    double q = X.norm() / (0.5 * (support[i] + support[j]));
    double W = kernel_weight(kernel, q);
    if (W <= 0.0) continue;
    if (allowed && !(i < j ? allowed(body, rest[i], rest[j]) : allowed(body, rest[j], rest[i]))) continue;
    row.push_back({j, static_cast<float>(W)});
  }
  return row;
}

}  // namespace

Neighborhood build_neighborhood(const Particles& particles, std::span<const Body> bodies,
                                const NeighborhoodSettings& settings, const LinkFilter& allowed) {
  check(particles, settings);
  std::size_t n = particles.size();
  Neighborhood result;
  result.support.resize(n);
  result.places.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    result.places[i] = {{particles.rest[i].x(), particles.rest[i].y(), particles.rest[i].z(), 0.0}};
  if (settings.portable) result.instructions = portable_instructions();
  std::vector<std::vector<Link>> rows(n);
  for (Index b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    if (body.particles.size() == 0) continue;
    std::span<const Vec3> rest(particles.rest);
    PointTree tree(rest.subspan(body.particles.begin, body.particles.size()));
    find_supports(tree, body, rest, settings, result.support);
    auto first = result.support.begin() + body.particles.begin,
         last = result.support.begin() + body.particles.end;
    double widest = *std::max_element(first, last);
    parallel_for_each(body.particles.size(), [&](std::size_t local) {
      Index i = body.particles.begin + static_cast<Index>(local);
      rows[i] = find_row(tree, bodies, b, rest, i, widest, result.support, settings.kernel, allowed);
    });
  }
  result.start.resize(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    result.start[i + 1] = result.start[i] + static_cast<Index>(rows[i].size());
  result.links.reserve(result.start[n]);
  for (std::vector<Link>& row : rows) {
    result.links.insert(result.links.end(), row.begin(), row.end());
    row = {};
  }
  return result;
}

}  // namespace deforma
