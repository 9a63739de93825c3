#include "assets/cells.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

namespace deforma {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int cubes = 4;  // along a spacing; even, so that the sides of a lattice's cells are sides of cubes
constexpr double whole = 2.0;     // spacings from the surface: deeper cells of a lattice are cubes
constexpr double least = 0.05;    // of an equal share: less would weigh nothing
constexpr double affected = 4.1;  // spacings from the surface: deeper blocks hold only parts of such cells

struct Cloud {
  std::span<const Vector3d> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::size_t>;

/// The blocks, one spacing wide, that cover a solid; cubes of every block lie alike.
struct Blocks {
  Vector3d start;
  Vector3d width;
  Eigen::Array3i count;

  // A lattice's blocks are its cells, but not across a body thinner than one, which could lie between their cubes;
  // otherwise they start at the bounds and are as wide as divides them evenly.
  Blocks(const Solid& solid, double spacing, const Vector3d& lattice_point, bool lattice)
      : width(Vector3d::Constant(spacing)) {
    const Vector3d &low = solid.facts().min, &high = solid.facts().max;
    start = low;
    for (int a = 0; a < 3; ++a) {
      if (!lattice || high[a] - low[a] < spacing) {
        count[a] = std::max(1, static_cast<int>(std::round((high[a] - low[a]) / spacing)));
        width[a] = (high[a] - low[a]) / count[a];
        continue;
      }
      const double phase = (lattice_point[a] - 0.5 * spacing - low[a]) / spacing;
      start[a] += (phase - std::ceil(phase - 1e-9)) * spacing;
      count[a] = std::max(1, static_cast<int>(std::ceil((high[a] - start[a]) / spacing - 1e-9)));
    }
  }
};

class Counter {
 public:
  Counter(const Solid& solid, std::span<const Vector3d> points, const Blocks& blocks)
      : solid_(solid),
        blocks_(blocks),
        step_(blocks.width / cubes),
        cloud_{points},
        tree_(3, cloud_, {10}),
        cells_(points.size()) {}

  // Columns of blocks side by side, what they give added up in one order whatever the threads.
  void count(double reach) {
    constexpr std::size_t at_once = 1024;
    const auto rows = static_cast<std::size_t>(blocks_.count[1]);
    const std::size_t columns = static_cast<std::size_t>(blocks_.count[0]) * rows;
    std::vector<std::vector<Part>> found(std::min(columns, at_once));
    for (std::size_t first = 0; first < columns; first += at_once) {
      const std::size_t some = std::min(at_once, columns - first);
      tbb::parallel_for(std::size_t{0}, some, [&](std::size_t c) {
        found[c].clear();
        const std::size_t x = (first + c) / rows, y = (first + c) % rows;
        collect(blocks_.start +
                    blocks_.width.cwiseProduct(Vector3d(static_cast<double>(x), static_cast<double>(y), 0.0)),
                reach, found[c]);
      });
      for (std::size_t c = 0; c < some; ++c)
        for (const Part& part : found[c]) add(part);
    }
  }

  std::vector<CellMoments>& cells() { return cells_; }

 private:
  /// What the cubes of a block give to one point.
  struct Part {
    std::size_t owner;
    int count;        // of cubes
    Vector3d first;   // sum of their arms
    Matrix3d second;  // sum of arm * arm^T
  };
  /// Which cubes of a column of blocks are inside, one line of cubes beside the other.
  using Inside = std::array<std::vector<char>, cubes * cubes>;

  Vector3d middle_of(const Vector3d& column, int z) const {
    return column + Vector3d(0, 0, z * blocks_.width.z()) + 0.5 * blocks_.width;
  }

  void collect(const Vector3d& column, double reach, std::vector<Part>& parts) const {
    std::vector<int> near;
    for (int z = 0; z < blocks_.count[2]; ++z)
      if (!std::isfinite(reach) || solid_.distance(middle_of(column, z), reach) < reach) near.push_back(z);
    if (near.empty()) return;
    Inside inside;
    for (int i = 0; i < cubes; ++i)
      for (int j = 0; j < cubes; ++j) {
        std::vector<char>& line = inside[static_cast<std::size_t>(i * cubes + j)];
        line.resize(static_cast<std::size_t>(blocks_.count[2] * cubes));
        const Vector3d first = column + step_.cwiseProduct(Vector3d(i + 0.5, j + 0.5, 0.5));
        solid_.mark_column(first.x(), first.y(), first.z(), step_.z(), line);
      }
    std::vector<Found> candidates;
    for (const int z : near) share_out(middle_of(column, z), z, inside, candidates, parts);
  }

  using Found = std::pair<std::size_t, double>;

  // Every point that can be the nearest to one of a block's cubes.
  void find_candidates(const Vector3d& middle, std::vector<Found>& candidates) const {
    std::size_t nearest = 0;
    double squared = 0.0;
    tree_.knnSearch(middle.data(), 1, &nearest, &squared);
    const double outermost = 0.5 * (blocks_.width - step_).norm();
    const double reach = (std::sqrt(squared) + 2.0 * outermost) * (1.0 + 1e-6);
    tree_.radiusSearch(middle.data(), reach * reach, candidates, nanoflann::SearchParams(32, 0.0F, false));
    std::sort(candidates.begin(), candidates.end());  // the first of two as near owns the cube
  }

  void share_out(const Vector3d& middle, int z, const Inside& inside, std::vector<Found>& candidates,
                 std::vector<Part>& parts) const {
    find_candidates(middle, candidates);
    const std::size_t first_part = parts.size();
    for (const Found& candidate : candidates)
      parts.push_back({candidate.first, 0, Vector3d::Zero(), Matrix3d::Zero()});
    const Vector3d corner = middle - 0.5 * blocks_.width;
    for (int i = 0; i < cubes; ++i)
      for (int j = 0; j < cubes; ++j)
        for (int k = 0; k < cubes; ++k) {
          if (!inside[static_cast<std::size_t>(i * cubes + j)][static_cast<std::size_t>(z * cubes + k)])
            continue;
          const Vector3d cube = corner + step_.cwiseProduct(Vector3d(i + 0.5, j + 0.5, k + 0.5));
          Part* owner = nullptr;
          double least_squared = std::numeric_limits<double>::infinity();
          for (std::size_t p = first_part; p < parts.size(); ++p) {
            const double squared = (cube - cloud_.points[parts[p].owner]).squaredNorm();
            if (squared >= least_squared) continue;
            least_squared = squared;
            owner = &parts[p];
          }
          const Vector3d arm = cube - cloud_.points[owner->owner];
          ++owner->count;
          owner->first += arm;
          owner->second += arm * arm.transpose();
        }
    const auto own = parts.begin() + static_cast<std::ptrdiff_t>(first_part);
    parts.erase(std::remove_if(own, parts.end(), [](const Part& part) { return part.count == 0; }),
                parts.end());
  }

  void add(const Part& part) {
    const double volume = step_.prod();
    CellMoments& cell = cells_[part.owner];
    cell.volume += part.count * volume;
    cell.first += volume * part.first;
    cell.second +=
        volume * (part.second + part.count * Matrix3d((step_.cwiseProduct(step_) / 12.0).asDiagonal()));
  }

  const Solid& solid_;
  const Blocks& blocks_;
  const Vector3d step_;  // sides of a cube
  Cloud cloud_;
  Tree tree_;
  std::vector<CellMoments> cells_;
};

}  // namespace

std::vector<CellMoments> particle_cells(const Solid& solid, std::span<const Vector3d> points, double spacing,
                                        bool lattice) {
  const double share = solid.volume() / static_cast<double>(points.size());
  if (!solid.closed()) return std::vector<CellMoments>(points.size(), {.volume = share});
  const Blocks blocks(solid, spacing, points.front(), lattice);
  Counter counter(solid, points, blocks);
  counter.count(lattice ? affected * spacing : std::numeric_limits<double>::infinity());
  std::vector<CellMoments> cells = std::move(counter.cells());

  const double cell = spacing * spacing * spacing;
  std::vector<char> deep(points.size(), 0);
  if (lattice)
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      if (solid.distance(points[i], whole * spacing) < whole * spacing) return;
      deep[i] = 1;
      cells[i] = {cell, Vector3d::Zero(), cell * spacing * spacing / 12.0 * Matrix3d::Identity()};
    });
  for (CellMoments& one : cells) one.volume = std::max(one.volume, least * share);
  double whole_volume = 0.0, clipped_volume = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) (deep[i] ? whole_volume : clipped_volume) += cells[i].volume;
  const double correction = (solid.volume() - whole_volume) / clipped_volume;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (deep[i]) continue;
    cells[i].volume *= correction;
    cells[i].first *= correction;
    cells[i].second *= correction;
  }
  return cells;
}

}  // namespace deforma
