#include "render/geometry.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "render/shaders.hpp"

namespace deforma {
namespace {

void check_look(const Look& look, const char* what, std::size_t number) {
  if (!look.color.allFinite() || (look.edges && !look.edges->allFinite()) ||
      !(look.opacity >= 0.0f && look.opacity <= 1.0f) ||
      !(look.roughness >= 0.0f && look.roughness <= 1.0f) ||
      !(look.metallic >= 0.0f && look.metallic <= 1.0f))
    throw std::invalid_argument(
        fmt::format("the look of {} {}: colour must be finite, opacity ({}), roughness ({}) and metallic "
                    "({}) from 0 to 1",
                    what, number, look.opacity, look.roughness, look.metallic));
}

void check_indices(const DrawnMesh& drawn, std::size_t number) {
  std::uint32_t highest = 0;
  for (const auto& triangle : drawn.triangles)
    highest = std::max({highest, triangle[0], triangle[1], triangle[2]});
  if (!drawn.triangles.empty() && highest >= drawn.points.size())
    throw std::invalid_argument(
        fmt::format("mesh {}: a triangle names point {} of {}", number, highest, drawn.points.size()));
}

/// By the sign of the volume between the triangles and the middle; so also for containers that are open at the top.
bool faces_inwards(const DrawnMesh& drawn, const Eigen::Vector3d& middle) {
  double volume = 0.0;
  for (const auto& [a, b, c] : drawn.triangles)
    volume += (drawn.points[a] - middle).dot((drawn.points[b] - middle).cross(drawn.points[c] - middle));
  return volume < 0.0;
}

/// Edges that one triangle alone has: rims of what is open, and creases where faces do not share their points.
std::vector<std::array<std::uint32_t, 2>> lone_edges(const DrawnMesh& drawn) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(3 * drawn.triangles.size());
  for (const auto& triangle : drawn.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      edges.push_back({low, high});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<std::array<std::uint32_t, 2>> lone;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1) lone.push_back(edges[i]);
    i = end;
  }
  return lone;
}

void check_values(std::span<const float> values, std::size_t points, const ColorScale* scale,
                  const char* what, std::size_t number) {
  if (!values.empty() && values.size() != points)
    throw std::invalid_argument(
        fmt::format("{} {}: {} points with {} values", what, number, points, values.size()));
  if (!values.empty() && !(scale && scale->map && scale->low < scale->high))
    throw std::invalid_argument(
        fmt::format("{} {}: values need a colour scale from a lower to a higher one", what, number));
}

/// How far a point, relative to the target, lies in front of the eye [m]; along the view where rays are parallel.
double distance_to(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector3d eye = camera.eye - camera.target;
  return camera.is_parallel() ? (eye - point).dot(eye.normalized()) : (eye - point).norm();
}

void attribute(GLuint place, GLint size, GLsizei stride, std::size_t offset) {
  glEnableVertexAttribArray(place);
  glVertexAttribPointer(place, size, GL_FLOAT, GL_FALSE, stride, reinterpret_cast<const void*>(offset));
}

void store(GLenum target, const void* data, std::size_t bytes) {
  glBufferData(target, static_cast<GLsizeiptr>(bytes), data, GL_STREAM_DRAW);
}

/// Places in the colour map as an attribute of the bound vertex array, or none.
void use_values(const gl::Buffer& places, bool by_value) {
  if (!by_value) return glDisableVertexAttribArray(ShaderPlaces::value);
  glBindBuffer(GL_ARRAY_BUFFER, places.id());
  attribute(ShaderPlaces::value, 1, sizeof(float), 0);
}

void store_places(const gl::Buffer& places, std::span<const float> values, const ColorScale& scale) {
  std::vector<float> staging;
  for (float value : values) staging.push_back(static_cast<float>(scale.place(value)));
  glBindBuffer(GL_ARRAY_BUFFER, places.id());
  store(GL_ARRAY_BUFFER, staging.data(), staging.size() * sizeof(float));
}

}  // namespace

void UploadedMesh::draw() const {
  glBindVertexArray(array.id());
  glDrawElements(GL_TRIANGLES, corners, GL_UNSIGNED_INT, nullptr);
}

void UploadedMesh::draw_edges() const {
  glBindVertexArray(edge_array.id());
  glDrawElements(GL_LINES, edge_ends, GL_UNSIGNED_INT, nullptr);
}

void UploadedSpheres::draw() const {
  glBindVertexArray(array.id());
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
}

SceneBounds Geometry::upload(const FrameContent& frame) {
  SceneBounds bounds;
  meshes_.resize(frame.meshes.size());
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    const Box box = upload_mesh(frame.meshes[i], meshes_[i], frame, i);
    bounds.content.add(box);
    if (frame.meshes[i].look.opacity >= 1.0f) bounds.casters.add(box);
  }
  spheres_.resize(frame.spheres.size());
  for (std::size_t i = 0; i < frame.spheres.size(); ++i) {
    const Box box = upload_spheres(frame.spheres[i], spheres_[i], frame, i);
    bounds.content.add(box);
    if (frame.spheres[i].look.opacity >= 1.0f) bounds.casters.add(box);
  }
  if (frame.ground) {
    bounds.has_ground = true;
    bounds.ground = frame.ground->height - frame.camera.target.z();
  }
  return bounds;
}

Box Geometry::upload_mesh(const DrawnMesh& drawn, UploadedMesh& mesh, const FrameContent& frame,
                          std::size_t number) {
  const Camera& camera = frame.camera;
  const bool flat = drawn.look.flat;
  if (drawn.normals.size() != drawn.points.size() && !(flat && drawn.normals.empty()))
    throw std::invalid_argument(
        fmt::format("mesh {}: {} points with {} normals; as many are needed, or none for a flat look", number,
                    drawn.points.size(), drawn.normals.size()));
  check_look(drawn.look, "mesh", number);
  check_values(drawn.values, drawn.points.size(), frame.color_scale, "mesh", number);
  check_indices(drawn, number);

  Box box;
  staging_.resize(6 * drawn.points.size());
  for (std::size_t i = 0; i < drawn.points.size(); ++i) {
    const Eigen::Vector3d point = drawn.points[i] - camera.target;
    if (!point.allFinite())
      throw std::invalid_argument(fmt::format("mesh {}: point {} is not finite", number, i));
    box.add(point);
    const Eigen::Vector3d normal = drawn.normals.empty() ? Eigen::Vector3d(0.0, 0.0, 1.0) : drawn.normals[i];
    Eigen::Map<Eigen::Vector3f> out_point(staging_.data() + 6 * i);
    Eigen::Map<Eigen::Vector3f> out_normal(staging_.data() + 6 * i + 3);
    out_point = point.cast<float>();
    out_normal = normal.cast<float>();
  }
  mesh.by_value = !drawn.values.empty();
  if (mesh.by_value) store_places(mesh.values, drawn.values, *frame.color_scale);
  glBindVertexArray(mesh.array.id());
  use_values(mesh.values, mesh.by_value);
  glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices.id());
  store(GL_ARRAY_BUFFER, staging_.data(), staging_.size() * sizeof(float));
  attribute(ShaderPlaces::position, 3, 6 * sizeof(float), 0);
  attribute(ShaderPlaces::normal, 3, 6 * sizeof(float), 3 * sizeof(float));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices.id());
  store(GL_ELEMENT_ARRAY_BUFFER, drawn.triangles.data(), drawn.triangles.size_bytes());
  mesh.corners = static_cast<GLsizei>(3 * drawn.triangles.size());
  mesh.edge_ends = 0;
  if (drawn.look.opacity < 1.0f) {
    const auto edges = lone_edges(drawn);
    glBindVertexArray(mesh.edge_array.id());
    use_values(mesh.values, mesh.by_value);
    glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices.id());
    attribute(ShaderPlaces::position, 3, 6 * sizeof(float), 0);
    attribute(ShaderPlaces::normal, 3, 6 * sizeof(float), 3 * sizeof(float));
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.edges.id());
    store(GL_ELEMENT_ARRAY_BUFFER, edges.data(), edges.size() * sizeof(edges[0]));
    mesh.edge_ends = static_cast<GLsizei>(2 * edges.size());
  }
  mesh.look = drawn.look;
  mesh.inside_out =
      drawn.look.opacity < 1.0f && !box.empty() && faces_inwards(drawn, box.center() + camera.target);
  mesh.distance = box.empty() ? 0.0 : distance_to(camera, box.center());
  return box;
}

Box Geometry::upload_spheres(const DrawnSpheres& drawn, UploadedSpheres& spheres, const FrameContent& frame,
                             std::size_t number) {
  const Camera& camera = frame.camera;
  if (!(drawn.radius > 0.0) || !std::isfinite(drawn.radius))
    throw std::invalid_argument(
        fmt::format("spheres {}: the radius must be positive, not {}", number, drawn.radius));
  check_look(drawn.look, "spheres", number);
  check_values(drawn.values, drawn.centers.size(), frame.color_scale, "spheres", number);
  std::vector<Eigen::Vector3d> centers;
  centers.reserve(drawn.centers.size());
  Box box;
  for (const Eigen::Vector3d& center : drawn.centers) {
    centers.push_back(center - camera.target);
    if (!centers.back().allFinite())
      throw std::invalid_argument(
          fmt::format("spheres {}: center {} is not finite", number, centers.size() - 1));
    box.add(centers.back(), drawn.radius);
  }
  std::vector<std::size_t> order(centers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (drawn.look.opacity < 1.0f)  // seen through each other: the far ones first
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return distance_to(camera, centers[a]) > distance_to(camera, centers[b]);
    });
  staging_.resize(3 * centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i) {
    Eigen::Map<Eigen::Vector3f> out(staging_.data() + 3 * i);
    out = centers[order[i]].cast<float>();
  }
  glBindVertexArray(spheres.array.id());
  spheres.by_value = !drawn.values.empty();
  if (spheres.by_value) {
    std::vector<float> values;
    for (std::size_t i : order) values.push_back(drawn.values[i]);
    store_places(spheres.values, values, *frame.color_scale);
    glVertexAttribDivisor(ShaderPlaces::value, 1);
  }
  use_values(spheres.values, spheres.by_value);
  glBindBuffer(GL_ARRAY_BUFFER, spheres.centers.id());
  store(GL_ARRAY_BUFFER, staging_.data(), staging_.size() * sizeof(float));
  attribute(ShaderPlaces::position, 3, 3 * sizeof(float), 0);
  glVertexAttribDivisor(ShaderPlaces::position, 1);
  spheres.count = static_cast<GLsizei>(centers.size());
  spheres.radius = static_cast<float>(drawn.radius);
  spheres.look = drawn.look;
  return box;
}

}  // namespace deforma
