#include "pipeline/shape_registry.hpp"

#include <fmt/core.h>

#include <array>
#include <stdexcept>
#include <type_traits>

#include "assets/import.hpp"
#include "assets/shapes.hpp"

namespace deforma {

namespace {

Setting length(std::string_view key, std::string_view meaning, double fallback) {
  return {key, "m", meaning, Curve<double>(fallback), true, Interval::positive(), {}, false};
}

Setting count(std::string_view key, std::string_view meaning, double fallback, double least) {
  return {key, "-", meaning, Curve<double>(fallback), false, Interval::closed(least, 1000.0), {}, false};
}

Setting lengths(std::string_view key, std::string_view meaning) {
  return {key, "m", meaning, Curve<Vec3>(Vec3(1, 1, 1)), true, {}, {}, false};
}

Setting flag(std::string_view key, std::string_view meaning) { return {key, "-", meaning, false}; }

double number(const Parameters& p, std::string_view key) { return p.number(key).at(0.0); }
int whole(const Parameters& p, std::string_view key) { return static_cast<int>(p.number(key).at(0.0)); }
Vec3 vector(const Parameters& p, std::string_view key) { return p.vector(key).at(0.0); }

ObstacleShape plane_obstacle(const Parameters& p, const std::filesystem::path&) {
  Vec3 normal = vector(p, "normal");
  if (normal.norm() == 0.0) throw std::invalid_argument("normal: expected any direction, found [0, 0, 0]");
  return PlaneShape{normal.normalized()};
}

ObstacleShape box_obstacle(const Parameters& p, const std::filesystem::path&) {
  Vec3 size = vector(p, "size");
  if (size.minCoeff() <= 0.0)
    throw std::invalid_argument(fmt::format("size: expected three lengths above 0 m, found [{}, {}, {}]",
                                            size.x(), size.y(), size.z()));
  return BoxShape{size, p.flag("inside"), p.flag("open")};
}

ObstacleShape mesh_obstacle(const Parameters& p, const std::filesystem::path& file) {
  Mesh mesh = import_mesh(file).mesh;
  transform(mesh, Mat3::Identity(), Vec3::Constant(number(p, "scale")), Vec3::Zero());
  return MeshShape{std::move(mesh.points), std::move(mesh.triangles)};
}

}  // namespace

std::span<const ShapeInfo> shape_registry() {
  static const Setting resolution =
      count("resolution", "cells along an edge or a quarter of the equator", 12, 1);
  static const std::array box = {lengths("size", "full lengths"), resolution};
  static const std::array sphere = {length("radius", "radius", 0.5), resolution};
  static const std::array ellipsoid = {lengths("radii", "half axes"), resolution};
  static const std::array cylinder = {length("radius", "radius", 0.5),
                                      length("height", "full length along z", 1.0),
                                      count("segments", "points around", 36, 3),
                                      count("rings", "rings of points, on the side and both caps", 15, 2)};
  static const std::array octahedron = {length("radius", "center to corner", 0.5), resolution};
  static const std::array torus = {length("radius", "center to the middle of the tube", 0.5),
                                   length("tube_radius", "radius of the tube", 0.2),
                                   count("segments", "points around the axis", 48, 3),
                                   count("rings", "points around the tube", 24, 3)};
  static const std::array<ShapeInfo, 6> registry = {{
      {"box", box, [](const Parameters& p) { return make_box(vector(p, "size"), whole(p, "resolution")); }},
      {"sphere", sphere,
       [](const Parameters& p) { return make_sphere(number(p, "radius"), whole(p, "resolution")); }},
      {"ellipsoid", ellipsoid,
       [](const Parameters& p) { return make_ellipsoid(vector(p, "radii"), whole(p, "resolution")); }},
      {"cylinder", cylinder,
       [](const Parameters& p) {
         return make_cylinder(number(p, "radius"), number(p, "height"), whole(p, "segments"),
                              whole(p, "rings"));
       }},
      {"octahedron", octahedron,
       [](const Parameters& p) { return make_octahedron(number(p, "radius"), whole(p, "resolution")); }},
      {"torus", torus,
       [](const Parameters& p) {
         return make_torus(number(p, "radius"), number(p, "tube_radius"), whole(p, "segments"),
                           whole(p, "rings"));
       }},
  }};
  return registry;
}

std::span<const ObstacleInfo> obstacle_registry() {
  using Path = std::filesystem::path;
  static const Setting inside = flag("inside", "keeps bodies in instead of out");
  static const Setting open = flag("open", "without its upper end");
  static const std::array plane = {
      Setting{"normal", "-", "away from the solid side", Curve<Vec3>(Vec3(0, 0, 1)), false, {}, {}, false}};
  static const std::array box = {lengths("size", "full lengths"), inside, open};
  static const std::array cylinder = {length("radius", "radius", 0.5),
                                      length("height", "full length along z", 1.0), inside, open};
  static const std::array sphere = {length("radius", "radius", 0.5), inside};
  static const std::array mesh = {Setting{"scale",
                                          "-",
                                          "factor on the file's lengths",
                                          Curve<double>(1.0),
                                          false,
                                          Interval::positive(),
                                          {},
                                          false}};
  static const std::array<ObstacleInfo, 5> registry = {{
      {"plane", plane, false, plane_obstacle},
      {"box", box, false, box_obstacle},
      {"cylinder", cylinder, false,
       [](const Parameters& p, const Path&) -> ObstacleShape {
         return CylinderShape{number(p, "radius"), number(p, "height"), p.flag("inside"), p.flag("open")};
       }},
      {"sphere", sphere, false,
       [](const Parameters& p, const Path&) -> ObstacleShape {
         return SphereShape{number(p, "radius"), p.flag("inside")};
       }},
      {"mesh", mesh, true, mesh_obstacle},
  }};
  return registry;
}

bool is_container(const ObstacleShape& shape) {
  return std::visit(
      [](const auto& s) {
        using Shape = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<Shape, PlaneShape> || std::is_same_v<Shape, MeshShape>)
          return false;
        else
          return s.inside;
      },
      shape);
}

}  // namespace deforma
