#include "sim/neighborhood.hpp"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "sim/compressed_rows.hpp"
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

/// What is near some particles of one body that are near each other: looked up once for all of them.
class Vicinity {
 public:
  Vicinity(const PointTree& tree, const Body& body, std::span<const Vec3> rest)
      : tree_(tree), first_(body.particles.begin), rest_(rest) {}

  /// Takes particles from `begin` on, as long as all are within `reach` [m] of each other; at least one.
  Range group(Index begin, Index end, double reach) {
    Eigen::AlignedBox3d box(rest_[begin]);
    Range group{begin, begin + 1};
    for (; group.end < end && group.size() < most_together; ++group.end) {
      Eigen::AlignedBox3d wider = box;
      if (wider.extend(rest_[group.end]).sizes().squaredNorm() > reach * reach) break;
      box = wider;
    }
    middle_ = box.center();
    radius_ = 0.5 * box.sizes().norm();
    return group;
  }

  /// Looks up every particle closer than `reach` [m] to any of the group.
  void find(double reach) {
    tree_.within(middle_, (reach + radius_) * 1.0001, found_);  // far from the origin the middle is rounded
    near_.resize(found_.size());
    for (std::size_t c = 0; c < found_.size(); ++c) near_[c] = first_ + found_[c].first;
    std::sort(near_.begin(), near_.end());
    for (int axis = 0; axis < 3; ++axis) {
      place_[axis].resize(near_.size());
      for (std::size_t c = 0; c < near_.size(); ++c) place_[axis][c] = rest_[near_[c]][axis];
    }
    squared_.resize(near_.size());
  }

  /// What was looked up, ascending.
  std::span<const Index> near() const { return near_; }

  /// Squared distances of all that was looked up from a place [m^2].
  std::span<const double> squared_distances(const Vec3& from) {
    const double *x = place_[0].data(), *y = place_[1].data(), *z = place_[2].data();
    double* squared = squared_.data();
    for (std::size_t c = 0, count = squared_.size(); c < count; ++c) {
      const double dx = x[c] - from.x(), dy = y[c] - from.y(), dz = z[c] - from.z();
      squared[c] = dx * dx + dy * dy + dz * dz;
    }
    return squared_;
  }

 private:
  static constexpr Index most_together = 12;

  const PointTree& tree_;
  const Index first_;
  std::span<const Vec3> rest_;
  Vec3 middle_ = Vec3::Zero();
  double radius_ = 0.0;
  std::vector<PointTree::Found> found_;
  std::vector<Index> near_;
  std::array<std::vector<double>, 3> place_;
  std::vector<double> squared_;
};

/// Mean distances of the k nearest others [m].
class MeanDistance {
 public:
  MeanDistance(const PointTree& tree, const Body& body, std::span<const Vec3> rest, std::size_t k)
      : tree_(tree), rest_(rest), k_(k), vicinity_(tree, body, rest) {}

  /// Of particles of the body, one after another.
  void find(Range particles, const auto& write) {
    for (Range group{particles.begin, particles.begin}; group.end < particles.end;) {
      const Index next = group.end;
      tree_.nearest(rest_[next], k_ + 1, found_);
      // Their neighbours reach about as far; who has some that reach farther is asked alone.
      const double reach = 1.2 * found_.back().second;
      group = vicinity_.group(next, particles.end, reach);
      if (group.size() > 1) vicinity_.find(reach);
      write(next, of_found());
      for (Index i = next + 1; i < group.end; ++i) write(i, of_vicinity(i, reach));
    }
  }

 private:
  // The particle itself adds zero.
  double of_found() const {
    double sum = 0.0;
    for (const auto& [j, distance] : found_) sum += distance;
    return sum / static_cast<double>(k_);
  }

  double of_vicinity(Index i, double reach) {
    const std::span<const double> squared = vicinity_.squared_distances(rest_[i]);
    within_.clear();
    for (const double s : squared)
      if (s < reach * reach) within_.push_back(s);
    if (within_.size() <= k_) {
      tree_.nearest(rest_[i], k_ + 1, found_);
      return of_found();
    }
    const auto last = within_.begin() + static_cast<std::ptrdiff_t>(k_);
    std::nth_element(within_.begin(), last, within_.end());
    std::sort(within_.begin(), last + 1);  // summed as those found one by one
    double sum = 0.0;
    for (auto s = within_.begin(); s <= last; ++s) sum += std::sqrt(*s);
    return sum / static_cast<double>(k_);
  }

  const PointTree& tree_;
  std::span<const Vec3> rest_;
  const std::size_t k_;
  Vicinity vicinity_;
  std::vector<PointTree::Found> found_;
  std::vector<double> within_;
};

// h_i = support * mean distance of the k nearest others. A particle without others has no links whatever its
// support.
void find_supports(const PointTree& tree, const Body& body, std::span<const Vec3> rest,
                   const NeighborhoodSettings& settings, std::vector<double>& support) {
  const int dimensions = dimensions_of(rest.subspan(body.particles.begin, body.particles.size()));
  const std::size_t k =
      std::min(as_many_as_in_space(settings.neighbors, dimensions), body.particles.size() - 1ul);
  auto write = [&](Index i, double mean) { support[i] = settings.support * (mean > 0.0 ? mean : 1.0); };
  if (k == 0) return write(body.particles.begin, body.spacing);
  constexpr Index block = 512;
  parallel_for_each(
      (body.particles.size() + block - 1) / block,
      [&](std::size_t b) {
        const Index begin = body.particles.begin + static_cast<Index>(b) * block;
        MeanDistance(tree, body, rest, k).find({begin, std::min(begin + block, body.particles.end)}, write);
      },
      1);
}

/// What the links of one body follow from.
struct Linking {
  const PointTree& tree;
  const Body& body;
  Index number;  // of the body
  std::span<const Vec3> rest;
  std::span<const double> support;
  double widest;  // of the supports
  Kernel kernel;
  const LinkFilter& allowed;

  void find_rows(Range particles, CompressedRows<Link>::Block& rows) const {
    Vicinity vicinity(tree, body, rest);
    for (Range group{particles.begin, particles.begin}; group.end < particles.end;) {
      group = vicinity.group(group.end, particles.end, widest);
      const auto highest = std::max_element(support.begin() + group.begin, support.begin() + group.end);
      vicinity.find(0.5 * (*highest + widest));
      for (Index i = group.begin; i < group.end; ++i) find_row(i, vicinity, rows);
    }
  }

  void find_row(Index i, Vicinity& vicinity, CompressedRows<Link>::Block& rows) const {
    const std::span<const double> squared = vicinity.squared_distances(rest[i]);
    for (std::size_t c = 0; c < squared.size(); ++c) {
      const Index j = vicinity.near()[c];
      const double h = 0.5 * (support[i] + support[j]);
      if (squared[c] >= h * h * (1.0 + 1e-9) || j == i) continue;
      const double distance = std::sqrt(squared[c]);
      if (!(distance < h)) continue;
      const double W = kernel_weight(kernel, distance / h);
      if (W <= 0.0) continue;
      if (allowed && !allowed(number, rest[std::min(i, j)], rest[std::max(i, j)])) continue;
      rows.add({j, static_cast<float>(W)});
    }
    rows.end_row();
  }
};

// Rows come in an order in which neighbours are near, so that most of what a row gathers from was used just before. For
// the rest the processor would have to wait: it cannot guess these places. Each row therefore names some that are wanted
// `early` rows later and have not been for `forgotten` rows.
std::vector<Ahead> look_ahead(const Neighborhood& links) {
  constexpr Index early = 128, forgotten = 1024, smallest = 4096;  // of smaller bodies all stays in the cache
  constexpr Index each = std::size(Ahead{}.j);
  const auto n = static_cast<Index>(links.size());
  if (n < smallest) return {};
  std::vector<Ahead> ahead(n);
  std::vector<Index> seen(n, 0);  // the last row that gathered from it, counted from 1
  std::size_t named = 0;
  for (Index i = 0; i < n; ++i) {
    named = std::max<std::size_t>(named, each * (i - std::min(i, early)));
    const Range row = links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Index j = links.links[l].j;
      if ((seen[j] == 0 || i + 1 - seen[j] > forgotten) && named < std::size_t{each} * i)
        ahead[named / each].j[named % each] = j, ++named;
      seen[j] = i + 1;
    }
  }
  return ahead;
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
  CompressedRows<Link> rows;
  for (Index b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    if (body.particles.size() == 0) continue;
    std::span<const Vec3> rest(particles.rest);
    PointTree tree(rest.subspan(body.particles.begin, body.particles.size()));
    find_supports(tree, body, rest, settings, result.support);
    auto first = result.support.begin() + body.particles.begin,
         last = result.support.begin() + body.particles.end;
    const Linking linking{
        tree, body, b, rest, result.support, *std::max_element(first, last), settings.kernel, allowed};
    rows.find(body.particles,
              [&](Range part, CompressedRows<Link>::Block& block) { linking.find_rows(part, block); });
  }
  rows.take(n, result.start, result.links);
  result.ahead = look_ahead(result);
  return result;
}

}  // namespace deforma
