#include <algorithm>
#include <cmath>

#include "assets/distance_chart.hpp"
#include "assets/mesh_tree.hpp"
#include "assets/sample.hpp"

namespace deforma {

namespace {

using Eigen::Vector3d;

constexpr double end_tolerance = 1e-6;  // of the way: a surface vertex lies on its own triangles

/// The side of the line from `a` along `way` on which the edge passes. Computed from its lower-numbered end, so that
/// both triangles at an edge agree to the last bit and no line slips between them.
double side_of(const MeshTree::Triangle& t, int from, int to, const Vector3d& a, const Vector3d& way) {
  bool swapped = t.point[from] > t.point[to];
  Vector3d p = t.corner[swapped ? to : from] - a, q = t.corner[swapped ? from : to] - a;
  double side = way.dot(p.cross(q));
  return swapped ? -side : side;
}

bool crosses(const MeshTree::Triangle& t, const Vector3d& a, const Vector3d& b) {
  Vector3d normal = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]);
  double from_a = normal.dot(a - t.corner[0]), from_b = normal.dot(b - t.corner[0]);
  if ((from_a > 0.0) == (from_b > 0.0) && from_a != 0.0 && from_b != 0.0) return false;
  if (from_a == from_b) return false;  // along the plane
  double way = from_a / (from_a - from_b);
  if (way <= end_tolerance || way >= 1.0 - end_tolerance) return false;
  Vector3d direction = b - a;
  double s0 = side_of(t, 0, 1, a, direction), s1 = side_of(t, 1, 2, a, direction),
         s2 = side_of(t, 2, 0, a, direction);
  return (s0 >= 0.0 && s1 >= 0.0 && s2 >= 0.0) || (s0 <= 0.0 && s1 <= 0.0 && s2 <= 0.0);
}

/// Whether the segment from `a` along `way` (with its componentwise inverse) touches the box; never misses.
bool touches(const Eigen::AlignedBox3d& box, const Vector3d& a, const Vector3d& b, const Vector3d& inverse) {
  double enter = 0.0, leave = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (a[axis] == b[axis]) {
      if (a[axis] < box.min()[axis] || a[axis] > box.max()[axis]) return false;
      continue;
    }
    double t0 = (box.min()[axis] - a[axis]) * inverse[axis], t1 = (box.max()[axis] - a[axis]) * inverse[axis];
    if (t0 > t1) std::swap(t0, t1);
    enter = std::max(enter, t0);
    leave = std::min(leave, t1);
  }
  return enter <= leave * (1.0 + 1e-12) + 1e-12;
}

}  // namespace

struct Visibility::Data {
  MeshTree tree;
  DistanceChart chart;

  Data(const Mesh& mesh, double spacing, std::size_t particles)
      : tree(mesh), chart(tree, spacing, particles) {}
};

Visibility::Visibility(const Mesh& mesh, double spacing, std::size_t particles)
    : data_(std::make_unique<Data>(mesh, spacing, particles)) {}
Visibility::~Visibility() = default;
Visibility::Visibility(Visibility&&) noexcept = default;
Visibility& Visibility::operator=(Visibility&&) noexcept = default;

bool Visibility::sees(const Vector3d& from, const Vector3d& to) const {
  // Always walked from the same end, so that rounding can not make it one-sided.
  bool swapped = std::lexicographical_compare(to.data(), to.data() + 3, from.data(), from.data() + 3);
  const Vector3d &a = swapped ? to : from, &b = swapped ? from : to;
  // Far from the surface nothing is near enough to be between.
  const double bound = std::max(data_->chart.at_least(a), data_->chart.at_least(b));
  if (bound * bound > (b - a).squaredNorm()) return true;
  Vector3d inverse = (b - a).cwiseInverse();
  bool clear = true;
  data_->tree.walk([&](std::uint32_t n) { return touches(data_->tree.nodes()[n].box, a, b, inverse); },
                   [&](const MeshTree::Triangle& t) {
                     clear = !crosses(t, a, b);
                     return clear;
                   });
  return clear;
}

}  // namespace deforma
