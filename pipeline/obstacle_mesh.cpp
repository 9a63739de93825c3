#include "pipeline/obstacle_mesh.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

#include "assets/shapes.hpp"

namespace deforma {

namespace {

constexpr int around = 96;  ///< points around a cylinder

/// A flat face: the parallelogram around `center` spanned by u and v, outside towards u x v.
void add_face(Mesh& mesh, const Vec3& center, const Vec3& u, const Vec3& v) {
  auto first = static_cast<Index>(mesh.points.size());
  for (const Vec3& corner : {Vec3(-u - v), Vec3(u - v), Vec3(u + v), Vec3(v - u)})
    mesh.points.push_back(center + 0.5 * corner);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

void turn_inwards(Mesh& mesh, bool inside) {
  if (!inside) return;
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

Mesh surface_of(const PlaneShape& plane, double plane_size) {
  Mesh mesh;
  Vec3 u = plane.normal.unitOrthogonal() * plane_size;
  add_face(mesh, Vec3::Zero(), u, plane.normal.normalized().cross(u));
  return mesh;
}

Mesh surface_of(const BoxShape& box, double) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 half = Vec3::Unit(axis) * box.size[axis] / 2;
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    Vec3 u = Vec3::Unit(a) * box.size[a], v = Vec3::Unit(b) * box.size[b];
    bool left_out = axis == 2 && box.inside && box.open;
    if (!left_out) add_face(mesh, half, u, v);
    add_face(mesh, -half, v, u);
  }
  turn_inwards(mesh, box.inside);
  return mesh;
}

void add_cap(Mesh& mesh, double radius, double z, bool upwards) {
  auto center = static_cast<Index>(mesh.points.size());
  mesh.points.emplace_back(0, 0, z);
  for (int k = 0; k < around; ++k) {
    double angle = 2 * std::numbers::pi * k / around;
    mesh.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  for (Index k = 0; k < around; ++k) {
    Index a = center + 1 + k, b = center + 1 + (k + 1) % around;
    mesh.triangles.push_back(upwards ? Triangle{center, a, b} : Triangle{center, b, a});
  }
}

Mesh surface_of(const CylinderShape& cylinder, double) {
  Mesh mesh;
  double half = cylinder.height / 2;
  for (int k = 0; k < around; ++k) {
    double angle = 2 * std::numbers::pi * k / around;
    Vec3 rim(cylinder.radius * std::cos(angle), cylinder.radius * std::sin(angle), 0);
    mesh.points.push_back(rim - half * Vec3::UnitZ());
    mesh.points.push_back(rim + half * Vec3::UnitZ());
  }
  for (Index k = 0; k < around; ++k) {
    Index a = 2 * k, b = 2 * ((k + 1) % around);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
  add_cap(mesh, cylinder.radius, -half, false);
  if (!(cylinder.inside && cylinder.open)) add_cap(mesh, cylinder.radius, half, true);
  turn_inwards(mesh, cylinder.inside);
  return mesh;
}

Mesh surface_of(const SphereShape& sphere, double) {
  Mesh mesh = make_sphere(sphere.radius, 24);
  turn_inwards(mesh, sphere.inside);
  return mesh;
}

Mesh surface_of(const MeshShape& shape, double) { return {shape.points, shape.triangles}; }

}  // namespace

Mesh make_obstacle_mesh(const ObstacleShape& shape, double plane_size) {
  return std::visit([&](const auto& s) { return surface_of(s, plane_size); }, shape);
}

}  // namespace deforma
