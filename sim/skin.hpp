#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/moving_least_squares.hpp"
#include "sim/neighborhood.hpp"
#include "sim/particles.hpp"
#include "sim/types.hpp"

namespace deforma {

using Triangle = std::array<Index, 3>;

/// How each surface vertex follows the particles near it, fixed in the reference configuration (eq 25):
///     u_s = sum_i w_i (u_i + grad u_i (X_s - X_i)),   sum w_i = 1,   w_i ~ exp(-r^2/h^2).
/// Linear in the particles' displacements and gradients, so that its transpose carries a force at a vertex
/// back to the particles exactly.
struct Skin {
  struct Tie {
    Index particle;
    double weight;  ///< w_i
    Vec3 arm;       ///< X_s - X_i [m]
  };
  std::vector<Index> start;  ///< m + 1 row starts
  std::vector<Tie> ties;

  std::span<const Tie> row(std::size_t s) const {
    return {ties.data() + start[s], ties.data() + start[s + 1]};
  }
};

/// The visible triangle surfaces of every body in one set of arrays.
struct Surface {
  std::vector<Vec3> rest;           ///< X_s [m]                                        m
  std::vector<Triangle> triangles;  ///< counter-clockwise seen from outside
  std::vector<Index> body;          ///< of each vertex                                 m
  std::vector<double> area;         ///< rest area that each vertex stands for [m^2]    m
  Skin skin;
  std::vector<Vec3> position;  ///< x_s [m], up to date only where `active`        m
  std::vector<Vec3> velocity;  ///< [m/s], up to date only where `active`          m
  std::vector<Index> active;   ///< vertices that some effect asked for, ascending

  std::size_t size() const { return rest.size(); }
};

/// Ties every vertex to the particles of its body within their support radius; where none is near enough (or
/// every weight underflows) to the nearest particle alone.
/// @param allowed as for `build_neighborhood`, called with (body, vertex, particle); ignored where it would leave
/// no tie
/// @throws std::invalid_argument when a body has vertices but no particle.
Skin bind_skin(const Particles& particles, std::span<const Body> bodies, const Neighborhood& links,
               std::span<const Vec3> vertices, const LinkFilter& allowed = {});

/// One third of each adjacent triangle's area per vertex [m^2].
std::vector<double> vertex_areas(std::span<const Vec3> points, std::span<const Triangle> triangles);

/// x_s = X_s + u_s of one vertex.
Vec3 skinned_point(const Skin& skin, std::size_t s, const Vec3& rest, std::span<const Vec3> displacement,
                   std::span<const Mat3> F, const MovingLeastSquares& fit);

/// The whole surface, as drawn.
/// @param F deformation gradients of the displacement given   n
/// @param points written [m]                                  m
/// @throws std::invalid_argument when the lengths differ.
void deform_surface(const Surface& surface, const Particles& particles, const MovingLeastSquares& fit,
                    std::span<const Mat3> F, std::span<Vec3> points);

/// Finds position and velocity of every active vertex: eq 25, and its rate.
/// @param F      deformation gradient                n
/// @param F_rate its rate [1/s]                      n
void move_active(Surface& surface, const Particles& particles, const MovingLeastSquares& fit,
                 std::span<const Mat3> F, std::span<const Mat3> F_rate);

/// The transpose: adds what a force at each active vertex does to the particles,
///     f_i += w_i f_s,   P_i += -(w_i / V_i) f_s (X_s - X_i)^T,
/// V_i being the weight of the particle's strain energy.
/// @param surface_force [N]  m
/// @param P [Pa]             n
/// @param force [N]          n
void add_surface_force(const Surface& surface, const MovingLeastSquares& fit,
                       std::span<const Vec3> surface_force, std::span<Mat3> P, std::span<Vec3> force);

/// Unit vertex normals, weighted by the angle of each corner; triangles without area are ignored, and a
/// vertex without any gets the z axis.
void vertex_normals(std::span<const Vec3> points, std::span<const Triangle> triangles,
                    std::span<Vec3> normals);

}  // namespace deforma
