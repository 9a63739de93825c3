#include "assets/mesh_tree.hpp"

#include <algorithm>
#include <cmath>

#include "assets/edges.hpp"

namespace deforma {

namespace {

using Eigen::Vector3d;

constexpr std::uint32_t leaf_size = 4;

Vector3d closest_on_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  Vector3d along = b - a;
  double length = along.squaredNorm();
  double t = length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return a + t * along;
}

Vector3d closest_on_triangle(const Vector3d& p, const std::array<Vector3d, 3>& corner) {
  Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  double area = normal.squaredNorm();
  bool above = area > 0.0;
  for (int i = 0; i < 3 && above; ++i) {
    const Vector3d &a = corner[i], &b = corner[(i + 1) % 3];
    above = normal.dot((b - a).cross(p - a)) >= 0.0;
  }
  if (above) return p - normal.dot(p - corner[0]) / area * normal;
  Vector3d best = closest_on_segment(p, corner[0], corner[1]);
  for (int i = 1; i < 3; ++i) {
    Vector3d other = closest_on_segment(p, corner[i], corner[(i + 1) % 3]);
    if ((other - p).squaredNorm() < (best - p).squaredNorm()) best = other;
  }
  return best;
}

Vector3d middle_of(const MeshTree::Triangle& t) { return (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0; }

}  // namespace

MeshTree::MeshTree(const Mesh& mesh) {
  check_indices(mesh);
  triangles_.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles_.push_back({{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}, t});
  nodes_.reserve(triangles_.size());
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t MeshTree::build(std::uint32_t first, std::uint32_t count) {
  auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box, middles;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const Vector3d& corner : triangles_[i].corner) box.extend(corner);
    middles.extend(middle_of(triangles_[i]));
  }
  nodes_[self] = {box, first, count, 0};
  if (count <= leaf_size) return self;

  int axis;
  middles.sizes().maxCoeff(&axis);
  auto begin = triangles_.begin() + first;
  // Ties are settled by the corners' numbers: which half a triangle goes to never depends on the library.
  std::nth_element(begin, begin + count / 2, begin + count, [axis](const Triangle& l, const Triangle& r) {
    double a = middle_of(l)[axis], b = middle_of(r)[axis];
    return a != b ? a < b : l.point < r.point;
  });
  build(first, count / 2);
  std::uint32_t right = build(first + count / 2, count - count / 2);
  nodes_[self].right = right;
  return self;
}

double MeshTree::distance(const Vector3d& from, double limit) const {
  std::optional<Vector3d> place = closest(from, limit);
  return place ? (*place - from).norm() : limit;
}

std::optional<Vector3d> MeshTree::closest(const Vector3d& from, double limit) const {
  std::optional<Vector3d> place;
  if (nodes_.empty()) return place;
  double best = limit * limit;
  std::array<std::pair<double, std::uint32_t>, 64> waiting;
  int depth = 0;
  waiting[depth++] = {nodes_[0].box.squaredExteriorDistance(from), 0};
  while (depth > 0) {
    auto [away, at] = waiting[--depth];
    if (away >= best) continue;
    const Node& node = nodes_[at];
    if (node.right == 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
        if (const Vector3d p = closest_on_triangle(from, triangles_[i].corner);
            (p - from).squaredNorm() < best) {
          best = (p - from).squaredNorm();
          place = p;
        }
      continue;
    }
    std::pair<double, std::uint32_t> near{nodes_[at + 1].box.squaredExteriorDistance(from), at + 1};
    std::pair<double, std::uint32_t> far{nodes_[node.right].box.squaredExteriorDistance(from), node.right};
    if (far.first < near.first) std::swap(near, far);
    waiting[depth++] = far;
    waiting[depth++] = near;
  }
  return place;
}

}  // namespace deforma
