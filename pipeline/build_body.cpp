#include "pipeline/build_body.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "assets/import.hpp"
#include "assets/sample.hpp"
#include "pipeline/user_error.hpp"
#include "sim/morton_order.hpp"
#include "sim/rotation.hpp"

namespace deforma {

namespace {

Mesh read_or_make(const SceneBody& body, std::vector<std::string>& warnings) {
  try {
    if (body.shape) return body.shape->info->make(body.shape->parameters);
    Imported imported = import_mesh(body.mesh_file);
    for (const std::string& warning : imported.warnings)
      warnings.push_back(fmt::format("{}: {}", body.name, warning));
    return std::move(imported.mesh);
  } catch (const std::exception& error) {
    throw UserError(fmt::format("{}: {}", body.mesh_where, error.what()));
  }
}

void refine(Mesh& mesh, const SceneBody& body) {
  subdivide(mesh, body.subdivide);
  if (!body.surface_particles) return;
  while (mesh.points.size() < static_cast<std::size_t>(*body.surface_particles)) subdivide(mesh, 1);
}

/// Where the body's pins hold its surface.
std::vector<SurfacePart> held_parts(const SceneBody& body) {
  std::vector<SurfacePart> parts;
  for (const SceneEffect& effect : body.effects) {
    if (effect.info->name != "pin") continue;
    const Region& region = effect.parameters.region("region");
    parts.push_back({region.min, region.max, region.center, region.radius});
  }
  return parts;
}

Sampling sample(const SceneBody& body, const Mesh& mesh, double bytes_per_particle,
                std::vector<std::string>& warnings) {
  SamplingSettings settings;
  settings.particles = static_cast<std::size_t>(body.particles.value_or(0));
  settings.spacing = body.spacing.value_or(0.0);
  settings.arrangement = body.sampling == "lattice"         ? Arrangement::lattice
                         : body.sampling == "body_centered" ? Arrangement::body_centered
                                                            : Arrangement::blue_noise;
  settings.bytes_per_particle = bytes_per_particle;
  settings.jitter = body.jitter;
  settings.held = held_parts(body);
  try {
    Sampling sampling = sample_interior(mesh, settings);
    for (const std::string& warning : sampling.warnings)
      warnings.push_back(fmt::format("{}: {}", body.name, warning));
    return sampling;
  } catch (const std::exception& error) {
    throw UserError(fmt::format("{}: {}", body.where, error.what()));
  }
}

/// The same volume for every particle, as if nothing were known of what it stands for.
void share_equally(Sampling& sampling) {
  const double share = sampling.volume() / static_cast<double>(sampling.cells.size());
  sampling.cells.assign(sampling.cells.size(), {.volume = share});
}

/// Room for so many more: exactly so much for the first body, and as vectors grow for the others.
void reserve(Particles& particles, std::size_t more) {
  const std::size_t n = particles.size() + more;
  auto grow = [n](auto& array) {
    if (array.capacity() < n) array.reserve(std::max(n, 2 * array.capacity()));
  };
  grow(particles.rest);
  grow(particles.displacement);
  grow(particles.velocity);
  grow(particles.mass);
  grow(particles.volume);
  grow(particles.cells);
  grow(particles.body);
}

/// Neighbours near in memory: what the simulation gathers from them is then mostly in the cache.
void order_along_curve(Sampling& sampling) {
  std::vector<Vec3> points;
  std::vector<CellMoments> cells;
  points.reserve(sampling.points.size());
  cells.reserve(sampling.points.size());
  for (const Index i : morton_order(sampling.points)) {
    points.push_back(sampling.points[i]);
    cells.push_back(sampling.cells[i]);
  }
  sampling.points = std::move(points);
  sampling.cells = std::move(cells);
}

}  // namespace

Mesh make_body_mesh(const SceneBody& body, std::vector<std::string>& warnings) {
  Mesh mesh = read_or_make(body, warnings);
  transform(mesh, rotation_matrix(radians_per_degree * body.rotation), body.scale, body.position);
  if (inspect(mesh).volume < 0.0) {
    warnings.push_back(fmt::format("{}: the mesh is inside-out; its triangles are turned round", body.name));
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  refine(mesh, body);
  return mesh;
}

void append_body(State& state, const SceneBody& body, const Mesh& mesh, double bytes_per_particle,
                 std::vector<std::string>& warnings) {
  Sampling sampling = sample(body, mesh, bytes_per_particle, warnings);
  order_along_curve(sampling);
  Particles& particles = state.particles;
  Surface& surface = state.surface;
  auto index = static_cast<Index>(state.bodies.size());
  auto first_particle = static_cast<Index>(particles.size());
  auto first_vertex = static_cast<Index>(surface.size());
  auto first_triangle = static_cast<Index>(surface.triangles.size());

  if (body.mass_rule != "cell") share_equally(sampling);
  double volume = 0.0;
  Vec3 moment = Vec3::Zero();
  for (std::size_t i = 0; i < sampling.points.size(); ++i) {
    volume += sampling.cells[i].volume;
    moment += sampling.cells[i].volume * sampling.points[i];
  }
  const Vec3 center = moment / volume;
  reserve(particles, sampling.points.size());
  for (std::size_t i = 0; i < sampling.points.size(); ++i) {
    const CellMoments& cell = sampling.cells[i];
    particles.rest.push_back(sampling.points[i]);
    particles.displacement.push_back(Vec3::Zero());
    particles.velocity.push_back(body.velocity + body.angular_velocity.cross(sampling.points[i] - center));
    particles.mass.push_back(body.density * cell.volume);
    particles.volume.push_back(cell.volume);
    particles.cells.push_back({cell.first, cell.second});
    particles.body.push_back(index);
  }
  surface.rest.insert(surface.rest.end(), mesh.points.begin(), mesh.points.end());
  surface.body.resize(surface.rest.size(), index);
  for (const Triangle& t : mesh.triangles)
    surface.triangles.push_back({t[0] + first_vertex, t[1] + first_vertex, t[2] + first_vertex});

  state.bodies.push_back({.name = body.name,
                          .particles = {first_particle, static_cast<Index>(particles.size())},
                          .vertices = {first_vertex, static_cast<Index>(surface.size())},
                          .triangles = {first_triangle, static_cast<Index>(surface.triangles.size())},
                          .spacing = sampling.spacing});
}

}  // namespace deforma
