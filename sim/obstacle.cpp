#include "sim/obstacle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "sim/rotation.hpp"
#include "sim/triangle_tree.hpp"

namespace deforma {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Distances of a point to the six walls of a box, negative beyond them; an open box has no +z wall.
struct Walls {
  Vec3 low, high;
  Walls(const BoxShape& box, const Vec3& p) : low(0.5 * box.size + p), high(0.5 * box.size - p) {
    if (box.inside && box.open) high.z() = infinity;
  }
};

double positive(double distance) { return std::max(distance, 0.0); }

// Each shape answers two questions: where does this point touch the solid, and how far is it from it?

void add(double depth, const Vec3& normal, double reach, std::vector<Touch>& touches) {
  if (depth > -reach) touches.push_back({depth, normal});
}

void find_in(const PlaneShape& plane, const Vec3& p, double reach, std::vector<Touch>& touches) {
  const Vec3 normal = plane.normal.normalized();
  add(-normal.dot(p), normal, reach, touches);
}

double clearance_of(const PlaneShape& plane, const Vec3& p) {
  return positive(plane.normal.normalized().dot(p));
}

void find_in(const BoxShape& box, const Vec3& p, double reach, std::vector<Touch>& touches) {
  const Walls walls(box, p);
  if (box.inside) {
    for (int axis = 0; axis < 3; ++axis) {
      add(-walls.low[axis], Vec3::Unit(axis), reach, touches);
      add(-walls.high[axis], -Vec3::Unit(axis), reach, touches);
    }
    return;
  }
  const Vec3 outside = (-walls.high).cwiseMax(0.0) - (-walls.low).cwiseMax(0.0);
  if (outside.squaredNorm() > 0.0) return add(-outside.norm(), outside.normalized(), reach, touches);
  Touch nearest{infinity, Vec3::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    if (walls.low[axis] < nearest.depth) nearest = {walls.low[axis], -Vec3::Unit(axis)};
    if (walls.high[axis] < nearest.depth) nearest = {walls.high[axis], Vec3::Unit(axis)};
  }
  add(nearest.depth, nearest.normal, reach, touches);
}

double clearance_of(const BoxShape& box, const Vec3& p) {
  const Walls walls(box, p);
  if (box.inside) return positive(walls.low.cwiseMin(walls.high).minCoeff());
  return (-walls.low).cwiseMax(-walls.high).cwiseMax(0.0).norm();
}

void find_in(const CylinderShape& cylinder, const Vec3& p, double reach, std::vector<Touch>& touches) {
  const double r = std::hypot(p.x(), p.y());
  const Vec3 outward = r > 0.0 ? Vec3(p.x() / r, p.y() / r, 0.0) : Vec3::UnitX();
  const double side = cylinder.radius - r, top = 0.5 * cylinder.height - p.z(),
               bottom = 0.5 * cylinder.height + p.z();
  if (cylinder.inside) {
    add(-side, -outward, reach, touches);
    add(-bottom, Vec3::UnitZ(), reach, touches);
    if (!cylinder.open) add(-top, -Vec3::UnitZ(), reach, touches);
    return;
  }
  const Vec3 outside = positive(-side) * outward + (positive(-top) - positive(-bottom)) * Vec3::UnitZ();
  if (outside.squaredNorm() > 0.0) return add(-outside.norm(), outside.normalized(), reach, touches);
  if (side <= top && side <= bottom)
    add(side, outward, reach, touches);
  else if (top <= bottom)
    add(top, Vec3::UnitZ(), reach, touches);
  else
    add(bottom, -Vec3::UnitZ(), reach, touches);
}

double clearance_of(const CylinderShape& cylinder, const Vec3& p) {
  const double side = cylinder.radius - std::hypot(p.x(), p.y());
  const double top = 0.5 * cylinder.height - p.z(), bottom = 0.5 * cylinder.height + p.z();
  if (cylinder.inside) return positive(std::min({side, bottom, cylinder.open ? infinity : top}));
  return std::hypot(positive(-side), positive(std::max(-top, -bottom)));
}

void find_in(const SphereShape& sphere, const Vec3& p, double reach, std::vector<Touch>& touches) {
  const double r = p.norm();
  const Vec3 outward = r > 0.0 ? Vec3(p / r) : Vec3(Vec3::UnitZ());
  if (sphere.inside)
    add(r - sphere.radius, -outward, reach, touches);
  else
    add(sphere.radius - r, outward, reach, touches);
}

double clearance_of(const SphereShape& sphere, const Vec3& p) {
  return positive(sphere.inside ? sphere.radius - p.norm() : p.norm() - sphere.radius);
}

// The first point at each place: a mesh whose triangles do not share their corners is closed all the same.
std::vector<Triangle> welded(const MeshShape& mesh) {
  std::map<std::array<double, 3>, Index> first;
  std::vector<Index> representative;
  for (Index i = 0; i < mesh.points.size(); ++i) {
    const Vec3& p = mesh.points[i];
    representative.push_back(first.try_emplace({p.x(), p.y(), p.z()}, i).first->second);
  }
  std::vector<Triangle> triangles = mesh.triangles;
  for (Triangle& t : triangles)
    for (Index& corner : t) corner = representative.at(corner);
  return triangles;
}

// A closed mesh with the normals that tell inside from outside at its faces, edges and corners.
// Source: Baerentzen & Aanaes, Signed distance computation using the angle weighted pseudonormal (2005).
class MeshSolid {
 public:
  explicit MeshSolid(const MeshShape& mesh)
      : tree_(mesh.points, mesh.triangles),
        triangles_(welded(mesh)),
        at_corner_(mesh.points.size(), Vec3::Zero()) {
    if (mesh.triangles.empty()) throw std::invalid_argument("a mesh obstacle needs at least one triangle");
    std::map<std::pair<Index, Index>, Vec3> edges;
    for (const Triangle& t : triangles_) {
      const Vec3 area = (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
      const Vec3 normal = area.norm() > 0.0 ? Vec3(area.normalized()) : Vec3(Vec3::Zero());
      face_.push_back(normal);
      for (int k = 0; k < 3; ++k) {
        const Index a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        at_corner_[a] += corner_angle(mesh.points[a], mesh.points[b], mesh.points[c]) * normal;
        edges.try_emplace(std::minmax(a, b), Vec3::Zero()).first->second += normal;
      }
    }
    for (const Triangle& t : triangles_)
      for (int k = 0; k < 3; ++k) at_edge_.push_back(edges.at(std::minmax(t[k], t[(k + 1) % 3])));
  }

  void find(const Vec3& p, double reach, std::vector<Touch>& touches) const {
    const Closest closest = tree_.closest(p);
    const Vec3 normal = normal_at(closest), apart = p - closest.point;
    if (closest.distance == 0.0) return add(0.0, normal.normalized(), reach, touches);
    const double side = apart.dot(normal) < 0.0 ? -1.0 : 1.0;
    add(-side * closest.distance, side / closest.distance * apart, reach, touches);
  }

  double clearance(const Vec3& p) const {
    const Closest closest = tree_.closest(p);
    return (p - closest.point).dot(normal_at(closest)) > 0.0 ? closest.distance : 0.0;
  }

 private:
  Vec3 normal_at(const Closest& closest) const {
    const Vec3& w = closest.barycentric;
    const Triangle& t = triangles_[closest.triangle];
    for (int k = 0; k < 3; ++k)
      if (w[k] == 1.0) return at_corner_[t[k]];
    for (int k = 0; k < 3; ++k)
      if (w[k] == 0.0) return at_edge_[3 * closest.triangle + (k + 1) % 3];
    return face_[closest.triangle];
  }

  TriangleTree tree_;
  std::vector<Triangle> triangles_;
  std::vector<Vec3> face_;       // unit, zero for a triangle without area
  std::vector<Vec3> at_edge_;    // three per triangle, from corner k to k + 1
  std::vector<Vec3> at_corner_;  // angle weighted
};

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

}  // namespace

Pose Obstacle::pose_at(double time) const { return {position.at(time), rotation_matrix(rotation.at(time))}; }

struct ObstacleField::Data {
  std::variant<PlaneShape, BoxShape, CylinderShape, SphereShape, MeshSolid> shape;
};

ObstacleField::ObstacleField(const Obstacle& obstacle)
    : data_(std::visit(
          Overloaded{[](const MeshShape& mesh) { return std::make_unique<Data>(Data{MeshSolid(mesh)}); },
                     [](const auto& shape) { return std::make_unique<Data>(Data{shape}); }},
          obstacle.shape)) {}

ObstacleField::~ObstacleField() = default;
ObstacleField::ObstacleField(ObstacleField&&) noexcept = default;
ObstacleField& ObstacleField::operator=(ObstacleField&&) noexcept = default;

void ObstacleField::find(const Vec3& point, std::vector<Touch>& touches, double reach) const {
  std::visit(Overloaded{[&](const MeshSolid& mesh) { mesh.find(point, reach, touches); },
                        [&](const auto& shape) { find_in(shape, point, reach, touches); }},
             data_->shape);
}

double ObstacleField::clearance(const Vec3& point) const {
  return std::visit(Overloaded{[&](const MeshSolid& mesh) { return mesh.clearance(point); },
                               [&](const auto& shape) { return clearance_of(shape, point); }},
                    data_->shape);
}

}  // namespace deforma
