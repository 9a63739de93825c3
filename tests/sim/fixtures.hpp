#pragma once

#include <cmath>
#include <random>

#include "sim/state.hpp"

namespace deforma {

/// The surface grid of an axis-aligned box with one corner at the origin, `cells` squares along each edge.
inline void add_box_surface(Surface& surface, const Vec3& size, const Eigen::Vector3i& cells) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      int a = (axis + 1) % 3, b = (axis + 2) % 3;
      Index first = static_cast<Index>(surface.rest.size());
      for (int i = 0; i <= cells[a]; ++i)
        for (int j = 0; j <= cells[b]; ++j) {
          Vec3 point;
          point[axis] = side * size[axis];
          point[a] = size[a] * i / cells[a];
          point[b] = size[b] * j / cells[b];
          surface.rest.push_back(point);
        }
      for (int i = 0; i < cells[a]; ++i)
        for (int j = 0; j < cells[b]; ++j) {
          Index row = static_cast<Index>(cells[b]) + 1;
          Index p = first + static_cast<Index>(i) * row + static_cast<Index>(j);
          Triangle lower = {p, p + row, p + row + 1}, upper = {p, p + row + 1, p + 1};
          if (side == 0) {
            std::swap(lower[1], lower[2]);
            std::swap(upper[1], upper[2]);
          }
          surface.triangles.push_back(lower);
          surface.triangles.push_back(upper);
        }
    }
  }
}

/// A box of nx x ny x nz particles at cell centres, one corner at the origin, with its surface (each face its
/// own grid), before `prepare_state`. Particles are moved by up to `jitter` spacings from their places,
/// always the same way.
inline State lattice_particles(const Vec3& size, int nx, int ny, int nz, double density,
                               double jitter = 0.0) {
  State state;
  Particles& p = state.particles;
  std::mt19937 generator(7);
  auto noise = [&] { return (generator() / 2147483648.0 - 1.0) * jitter; };
  Vec3 cell(size.x() / nx, size.y() / ny, size.z() / nz);
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        Vec3 at(i + 0.5 + noise(), j + 0.5 + noise(), k + 0.5 + noise());
        p.rest.push_back(cell.cwiseProduct(at));
        const Vec3 off = cell.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5)) - p.rest.back();
        const Mat3 own = cell.cwiseProduct(cell).asDiagonal();
        p.cells.push_back({cell.prod() * off, cell.prod() * (own / 12.0 + off * off.transpose())});
      }
  std::size_t n = p.rest.size();
  double volume = size.prod() / static_cast<double>(n);
  p.displacement.assign(n, Vec3::Zero());
  p.velocity.assign(n, Vec3::Zero());
  p.mass.assign(n, density * volume);
  p.volume.assign(n, volume);
  p.body.assign(n, 0);
  add_box_surface(state.surface, size, {nx, ny, nz});
  state.surface.body.assign(state.surface.size(), 0);
  Body body;
  body.name = "box";
  body.particles = {0, static_cast<Index>(n)};
  body.vertices = {0, static_cast<Index>(state.surface.size())};
  body.triangles = {0, static_cast<Index>(state.surface.triangles.size())};
  body.spacing = std::cbrt(volume);
  state.bodies.push_back(body);
  return state;
}

/// The same, prepared.
inline State lattice_box(const Vec3& size, int nx, int ny, int nz, double density, double jitter = 0.0,
                         const NeighborhoodSettings& settings = {}, Gradient gradient = Gradient::linear) {
  State state = lattice_particles(size, nx, ny, nz, density, jitter);
  prepare_state(state, settings, {}, {}, gradient);
  return state;
}

/// Appends another body's particles and surface, moved by `offset`; prepare the result anew.
inline void append_body(State& state, const State& other, const Vec3& offset) {
  auto particle_shift = static_cast<Index>(state.size());
  auto vertex_shift = static_cast<Index>(state.surface.size());
  auto triangle_shift = static_cast<Index>(state.surface.triangles.size());
  auto body_shift = static_cast<Index>(state.bodies.size());
  for (std::size_t i = 0; i < other.size(); ++i) {
    state.particles.rest.push_back(other.particles.rest[i] + offset);
    state.particles.displacement.push_back(other.particles.displacement[i]);
    state.particles.velocity.push_back(other.particles.velocity[i]);
    state.particles.mass.push_back(other.particles.mass[i]);
    state.particles.volume.push_back(other.particles.volume[i]);
    if (!other.particles.cells.empty()) state.particles.cells.push_back(other.particles.cells[i]);
    state.particles.body.push_back(other.particles.body[i] + body_shift);
  }
  for (std::size_t s = 0; s < other.surface.size(); ++s) {
    state.surface.rest.push_back(other.surface.rest[s] + offset);
    state.surface.body.push_back(other.surface.body[s] + body_shift);
  }
  for (Triangle t : other.surface.triangles) {
    for (Index& corner : t) corner += vertex_shift;
    state.surface.triangles.push_back(t);
  }
  for (Body body : other.bodies) {
    body.particles = {body.particles.begin + particle_shift, body.particles.end + particle_shift};
    body.vertices = {body.vertices.begin + vertex_shift, body.vertices.end + vertex_shift};
    body.triangles = {body.triangles.begin + triangle_shift, body.triangles.end + triangle_shift};
    state.bodies.push_back(body);
  }
}

}  // namespace deforma
