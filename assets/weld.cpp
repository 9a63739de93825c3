#include "assets/weld.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace deforma {

namespace {

using Eigen::Vector3d;
using Cell = std::array<std::int64_t, 3>;

constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();
constexpr double weld_tolerance = 1e-6;  // of the diagonal: ten times the rounding of a single-precision file
constexpr double height_tolerance = 1e-7;  // of the diagonal: the rounding itself

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (std::int64_t c : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15ull;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// Points in cells much wider than the tolerance, so that most look-ups touch one cell only.
class PointGrid {
 public:
  PointGrid(const std::vector<Vector3d>& points, double tolerance)
      : points_(points), next_(points.size(), nobody), tolerance_(tolerance), width_(16.0 * tolerance) {
    cells_.reserve(points.size());
  }

  /// The first point within the tolerance, or nobody.
  std::uint32_t find(const Vector3d& p) const {
    Cell low = cell_of(p.array() - tolerance_), high = cell_of(p.array() + tolerance_);
    std::uint32_t found = nobody;
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          auto cell = cells_.find({x, y, z});
          if (cell == cells_.end()) continue;
          for (std::uint32_t i = cell->second; i != nobody; i = next_[i])
            if ((points_[i] - p).squaredNorm() <= tolerance_ * tolerance_) found = std::min(found, i);
        }
    return found;
  }

  void add(std::uint32_t i) {
    auto [entry, is_new] = cells_.try_emplace(cell_of(points_[i]), i);
    if (is_new) return;
    next_[i] = entry->second;
    entry->second = i;
  }

 private:
  Cell cell_of(const Vector3d& p) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) cell[axis] = static_cast<std::int64_t>(std::floor(p[axis] / width_));
    return cell;
  }

  const std::vector<Vector3d>& points_;
  std::vector<std::uint32_t> next_;
  std::unordered_map<Cell, std::uint32_t, CellHash> cells_;
  double tolerance_;
  double width_;
};

bool has_height(const Mesh& mesh, const std::array<std::uint32_t, 3>& t, double least) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return false;
  Vector3d ab = mesh.points[t[1]] - mesh.points[t[0]], ac = mesh.points[t[2]] - mesh.points[t[0]];
  double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
  return ab.cross(ac).norm() > least * longest;
}

void drop_unused_points(Mesh& mesh) {
  std::vector<char> used(mesh.points.size(), 0);
  for (const auto& t : mesh.triangles)
    for (std::uint32_t corner : t) used[corner] = 1;
  std::vector<std::uint32_t> renamed(mesh.points.size(), nobody);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (used[i]) {
      renamed[i] = static_cast<std::uint32_t>(kept);
      mesh.points[kept++] = mesh.points[i];
    }
  mesh.points.resize(kept);
  for (auto& t : mesh.triangles)
    for (std::uint32_t& corner : t) corner = renamed[corner];
}

}  // namespace

WeldReport weld(Mesh& mesh) {
  WeldReport report;
  Eigen::AlignedBox3d bounds;
  for (const auto& t : mesh.triangles)
    for (std::uint32_t corner : t) bounds.extend(mesh.points[corner]);
  double diagonal = bounds.isEmpty() ? 0.0 : bounds.diagonal().norm();
  if (diagonal == 0.0) {
    report.dropped_triangles = mesh.triangles.size();
    mesh = Mesh{};
    return report;
  }

  // Measured from the corner of the bounds, so that a cell number always fits its integer.
  std::vector<Vector3d> local(mesh.points.size());
  for (std::size_t i = 0; i < local.size(); ++i) local[i] = mesh.points[i] - bounds.min();
  std::vector<char> used(mesh.points.size(), 0);
  for (const auto& t : mesh.triangles)
    for (std::uint32_t corner : t) used[corner] = 1;

  PointGrid grid(local, weld_tolerance * diagonal);
  std::vector<std::uint32_t> stands_for(local.size(), nobody);
  for (std::uint32_t i = 0; i < local.size(); ++i) {
    if (!used[i]) continue;
    std::uint32_t earlier = grid.find(local[i]);
    stands_for[i] = earlier == nobody ? i : earlier;
    if (earlier == nobody)
      grid.add(i);
    else
      ++report.welded_points;
  }

  std::size_t before = mesh.triangles.size();
  for (auto& t : mesh.triangles)
    for (std::uint32_t& corner : t) corner = stands_for[corner];
  std::erase_if(mesh.triangles,
                [&](const auto& t) { return !has_height(mesh, t, height_tolerance * diagonal); });
  report.dropped_triangles = before - mesh.triangles.size();
  drop_unused_points(mesh);
  return report;
}

}  // namespace deforma
