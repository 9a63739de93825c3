#include "assets/cells.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
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
      : solid_(solid), blocks_(blocks), cloud_{points}, tree_(3, cloud_, {10}), cells_(points.size()) {}

  // Layers of blocks side by side, their cubes counted in one order whatever the threads.
  void count(double reach) {
    std::vector<std::vector<Cube>> rows(static_cast<std::size_t>(blocks_.count[1]));
    for (int x = 0; x < blocks_.count[0]; ++x) {
      tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t y) {
        rows[y].clear();
        for (int z = 0; z < blocks_.count[2]; ++z)
          collect(blocks_.start + blocks_.width.cwiseProduct(Vector3d(x, static_cast<double>(y), z)), reach,
                  rows[y]);
      });
      for (const auto& row : rows)
        for (const Cube& cube : row) add(cube);
    }
  }

  std::vector<CellMoments>& cells() { return cells_; }

 private:
  struct Cube {
    Vector3d middle;
    std::size_t owner;
  };

  void collect(const Vector3d& corner, double reach, std::vector<Cube>& found) const {
    const Vector3d middle = corner + 0.5 * blocks_.width;
    if (std::isfinite(reach) && solid_.distance(middle, reach) >= reach) return;
    const Vector3d step = blocks_.width / cubes;
    std::vector<char> inside(cubes);
    for (int i = 0; i < cubes; ++i)
      for (int j = 0; j < cubes; ++j) {
        const Vector3d first = corner + step.cwiseProduct(Vector3d(i + 0.5, j + 0.5, 0.5));
        solid_.mark_column(first.x(), first.y(), first.z(), step.z(), inside);
        for (int k = 0; k < cubes; ++k)
          if (inside[k]) found.push_back(owned(first + Vector3d(0, 0, k * step.z())));
      }
  }

  Cube owned(const Vector3d& middle) const {
    std::size_t nearest = 0;
    double squared = 0.0;
    tree_.knnSearch(middle.data(), 1, &nearest, &squared);
    return {middle, nearest};
  }

  void add(const Cube& cube) {
    const Vector3d step = blocks_.width / cubes;
    const double volume = step.prod();
    const Vector3d arm = cube.middle - cloud_.points[cube.owner];
    CellMoments& cell = cells_[cube.owner];
    cell.volume += volume;
    cell.first += volume * arm;
    cell.second += volume * (arm * arm.transpose() + Matrix3d((step.cwiseProduct(step) / 12.0).asDiagonal()));
  }

  const Solid& solid_;
  const Blocks& blocks_;
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
