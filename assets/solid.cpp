#include "assets/solid.hpp"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "assets/edges.hpp"

namespace deforma {

namespace {

using Eigen::Vector3d;

// An open flat sheet has 1/2 exactly on it; rounding must not make that a volume.
constexpr double inside_threshold = 0.5 + 1e-6;
constexpr double sheet = 0.6;   // |sum of area vectors| / area: 0 closed, 0.5 a half sphere, 1 a flat sheet
constexpr double flat = 1e-12;  // of the cube of the diagonal: below it there is no volume
constexpr double columns_counted =
    2e4;  // through a closed mesh, to find overlaps and the volume of their union
constexpr double points_counted = 5e4;  // through an open mesh, where each costs a winding number

/// No boundary in the sense of homology: then the winding number is a whole number everywhere, and adding up crossings
/// along any line gives it exactly.
bool is_closed(const Mesh& mesh) {
  auto edges = edges_of(mesh);
  return std::all_of(edges.begin(), edges.end(), [](const Edge& e) { return e.forward == e.backward; });
}

/// The side of the edge a-b on which (x, y) lies seen from above: +1 left, -1 right, 0 for an edge seen as a point.
/// Computed from the lower-numbered end, so that both triangles at an edge agree to the last bit; a point exactly on
/// the edge is taken as moved by (e, e^2) for an infinitely small e.
int side_of(const MeshTree::Triangle& t, int from, int to, double x, double y) {
  bool swapped = t.point[from] > t.point[to];
  const Vector3d& a = t.corner[swapped ? to : from];
  const Vector3d& b = t.corner[swapped ? from : to];
  double side = (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
  if (side == 0.0) side = a.y() - b.y();
  if (side == 0.0) side = b.x() - a.x();
  int sign = (side > 0.0) - (side < 0.0);
  return swapped ? -sign : sign;
}

/// How much of the area faces one way: what is missing to close the mesh, as a share of its area.
double openness(const Mesh& mesh, double area) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : mesh.triangles) {
    const Vector3d& a = mesh.points[t[0]];
    sum += 0.5 * (mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a);
  }
  return area > 0.0 ? sum.norm() / area : 1.0;
}

double height_at(const std::array<Vector3d, 3>& corner, double x, double y) {
  std::array<double, 3> weight;
  for (int i = 0; i < 3; ++i) {
    const Vector3d &a = corner[(i + 1) % 3], &b = corner[(i + 2) % 3];
    weight[i] = (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
  }
  double sum = weight[0] + weight[1] + weight[2];
  double low = std::min({corner[0].z(), corner[1].z(), corner[2].z()});
  double high = std::max({corner[0].z(), corner[1].z(), corner[2].z()});
  if (sum == 0.0) return 0.5 * (low + high);
  double z = (weight[0] * corner[0].z() + weight[1] * corner[1].z() + weight[2] * corner[2].z()) / sum;
  return std::clamp(z, low, high);
}

}  // namespace

Solid::Solid(const Mesh& mesh)
    : facts_(inspect(mesh)), tree_(mesh), winding_(tree_), closed_(is_closed(mesh)) {
  double least = flat * std::pow((facts_.max - facts_.min).norm(), 3);
  if ((facts_.max - facts_.min).prod() <= least) return;
  if (!closed_ && openness(mesh, facts_.area) > sheet) return;
  bool irregular = false;
  double counted = count_volume(irregular);
  volume_ = closed_ && !irregular ? std::abs(facts_.volume) : counted;
  if (volume_ <= least) volume_ = 0.0;

  if (!closed_ && facts_.boundary_edges > 0)
    warnings_.push_back(
        fmt::format("the mesh is open, it has {} boundary edges: inside is where it winds around more "
                    "than half, and the volume is counted",
                    facts_.boundary_edges));
  if (facts_.non_manifold_edges > 0)
    warnings_.push_back(
        fmt::format("the mesh has {} edges where more than two triangles meet or two disagree about "
                    "their outside",
                    facts_.non_manifold_edges));
  if (irregular)
    warnings_.emplace_back(
        "parts of the mesh overlap or face opposite ways: their union is filled, and its volume is "
        "counted");
}

bool Solid::winds_around(const Vector3d& point) const {
  return std::abs(winding_.at(point)) > inside_threshold;
}

bool Solid::contains(const Vector3d& point) const {
  std::vector<char> inside(1);
  mark_column(point.x(), point.y(), point.z(), 1.0, inside);
  return inside[0] != 0;
}

bool Solid::cross_column(double x, double y, std::vector<Crossing>& crossings) const {
  crossings.clear();
  tree_.walk(
      [&](std::uint32_t n) {
        const Eigen::AlignedBox3d& box = tree_.nodes()[n].box;
        return x >= box.min().x() && x <= box.max().x() && y >= box.min().y() && y <= box.max().y();
      },
      [&](const MeshTree::Triangle& t) {
        int side = side_of(t, 0, 1, x, y);
        if (side != 0 && side == side_of(t, 1, 2, x, y) && side == side_of(t, 2, 0, x, y))
          crossings.push_back({height_at(t.corner, x, y), -side});  // seen from above: going up leaves
        return true;
      });
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& l, const Crossing& r) { return l.z != r.z ? l.z < r.z : l.step > r.step; });
  int winding = 0;
  for (const Crossing& crossing : crossings) winding += crossing.step;
  return winding == 0;
}

void Solid::mark_column(double x, double y, double z0, double step, std::vector<char>& inside) const {
  std::vector<Crossing> crossings;
  if (closed_ && cross_column(x, y, crossings)) {
    int winding = 0;
    std::size_t next = 0;
    for (std::size_t k = 0; k < inside.size(); ++k) {
      double z = z0 + step * static_cast<double>(k);
      for (; next < crossings.size() && crossings[next].z < z; ++next) winding += crossings[next].step;
      inside[k] = winding != 0;
    }
    return;
  }
  for (std::size_t k = 0; k < inside.size(); ++k)
    inside[k] = winds_around({x, y, z0 + step * static_cast<double>(k)});
}

double Solid::count_column(double x, double y, double cell, bool& irregular) const {
  std::vector<Crossing> crossings;
  if (closed_ && cross_column(x, y, crossings)) {
    int right_way = facts_.volume >= 0.0 ? 1 : -1;
    int winding = 0;
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
      winding += crossings[i].step;
      double between = crossings[i + 1].z - crossings[i].z;
      if (winding != 0) length += between;
      // Thinner than this it is rounding where parts touch, not an overlap.
      if (winding != 0 && winding != right_way && between > 1e-6 * (facts_.max - facts_.min).norm())
        irregular = true;
    }
    return length;
  }
  auto cells = static_cast<std::size_t>(std::ceil((facts_.max.z() - facts_.min.z()) / cell));
  double step = (facts_.max.z() - facts_.min.z()) / static_cast<double>(cells);
  std::vector<char> inside(cells);
  mark_column(x, y, facts_.min.z() + 0.5 * step, step, inside);
  return step * static_cast<double>(std::accumulate(inside.begin(), inside.end(), 0));
}

double Solid::count_volume(bool& irregular) const {
  Vector3d size = facts_.max - facts_.min;
  double cell =
      closed_ ? std::sqrt(size.x() * size.y() / columns_counted) : std::cbrt(size.prod() / points_counted);
  auto nx = static_cast<std::size_t>(std::ceil(size.x() / cell));
  auto ny = static_cast<std::size_t>(std::ceil(size.y() / cell));
  double dx = size.x() / static_cast<double>(nx), dy = size.y() / static_cast<double>(ny);
  std::vector<double> row_length(nx, 0.0);
  std::vector<char> row_irregular(nx, 0);
  tbb::parallel_for(std::size_t{0}, nx, [&](std::size_t i) {
    bool row = false;
    for (std::size_t j = 0; j < ny; ++j)
      row_length[i] += count_column(facts_.min.x() + dx * (static_cast<double>(i) + 0.5),
                                    facts_.min.y() + dy * (static_cast<double>(j) + 0.5), cell, row);
    row_irregular[i] = row;
  });
  irregular = std::any_of(row_irregular.begin(), row_irregular.end(), [](char c) { return c != 0; });
  return dx * dy * std::accumulate(row_length.begin(), row_length.end(), 0.0);
}

}  // namespace deforma
