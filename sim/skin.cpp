#include "sim/skin.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/compressed_rows.hpp"
#include "sim/parallel.hpp"
#include "sim/point_tree.hpp"

namespace deforma {

namespace {

// Eq 25's Gaussian is still 0.37 at one support radius: cut there, it leaves creases between vertices that do
// and do not reach a particle. It is cut a little farther out and shifted to reach zero at the cut.
constexpr double reach = 1.25;  // support radii

double tie_weight(double r, double h) {
  double q = r / h;
  return q < reach ? std::exp(-q * q) - std::exp(-reach * reach) : 0.0;
}

/// What the ties to one body follow from.
struct Tying {
  const PointTree& tree;
  const Particles& particles;
  const Neighborhood& links;
  Index first, number;  // particle of the body, and which it is
  double widest;        // of its supports [m]
  const LinkFilter& allowed;

  void find_ties(const Vec3& vertex, std::vector<PointTree::Found>& near,
                 std::vector<Skin::Tie>& ties) const {
    ties.clear();
    double sum = 0.0;
    tree.within(vertex, reach * widest, near);
    std::sort(near.begin(), near.end());
    for (const auto& [local, distance] : near) {
      const Index i = first + local;
      const double weight = tie_weight(distance, links.support[i]);
      if (weight <= 0.0 || (allowed && !allowed(number, vertex, particles.rest[i]))) continue;
      ties.push_back({i, weight, vertex - particles.rest[i]});
      sum += weight;
    }
    for (Skin::Tie& tie : ties) tie.weight /= sum;
    if (sum > 0.0) return;
    tree.nearest(vertex, 1, near);
    const Index nearest = first + near.front().first;
    ties = {{nearest, 1.0, vertex - particles.rest[nearest]}};
  }
};

}  // namespace

Skin bind_skin(const Particles& particles, std::span<const Body> bodies, const Neighborhood& links,
               std::span<const Vec3> vertices, const LinkFilter& allowed) {
  CompressedRows<Skin::Tie> rows;
  for (Index b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    if (body.vertices.size() == 0) continue;
    if (body.particles.size() == 0)
      throw std::invalid_argument(fmt::format("body '{}' has {} surface vertices but no particle to follow",
                                              body.name, body.vertices.size()));
    PointTree tree(std::span(particles.rest).subspan(body.particles.begin, body.particles.size()));
    const double widest = *std::max_element(links.support.begin() + body.particles.begin,
                                            links.support.begin() + body.particles.end);
    const Tying tying{tree, particles, links, body.particles.begin, b, widest, allowed};
    rows.find(body.vertices, [&](Range part, CompressedRows<Skin::Tie>::Block& block) {
      std::vector<PointTree::Found> near;
      std::vector<Skin::Tie> ties;
      for (Index s = part.begin; s < part.end; ++s) {
        tying.find_ties(vertices[s], near, ties);
        for (const Skin::Tie& tie : ties) block.add(tie);
        block.end_row();
      }
    });
  }
  Skin skin;
  rows.take(vertices.size(), skin.start, skin.ties);
  return skin;
}

std::vector<double> vertex_areas(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  std::vector<double> area(points.size(), 0.0);
  for (const Triangle& t : triangles) {
    double third = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm() / 6.0;
    for (Index corner : t) area[corner] += third;
  }
  return area;
}

Vec3 skinned_point(const Skin& skin, std::size_t s, const Vec3& rest, std::span<const Vec3> displacement,
                   std::span<const Mat3> F, const MovingLeastSquares& fit) {
  Vec3 u = Vec3::Zero();
  for (const Skin::Tie& tie : skin.row(s))  // eqs 25, 26
    u +=
        tie.weight * (displacement[tie.particle] + (F[tie.particle] - fit.projector(tie.particle)) * tie.arm);
  return rest + u;
}

void deform_surface(const Surface& surface, const Particles& particles, const MovingLeastSquares& fit,
                    std::span<const Mat3> F, std::span<Vec3> points) {
  if (points.size() != surface.size() || F.size() != particles.size())
    throw std::invalid_argument(fmt::format("{} vertices and {} particles, but {} points and {} gradients",
                                            surface.size(), particles.size(), points.size(), F.size()));
  parallel_for_each(surface.size(), [&](std::size_t s) {
    points[s] = skinned_point(surface.skin, s, surface.rest[s], particles.displacement, F, fit);
  });
}

void move_active(Surface& surface, const Particles& particles, const MovingLeastSquares& fit,
                 std::span<const Mat3> F, std::span<const Mat3> F_rate) {
  parallel_for_each(
      surface.active.size(),
      [&](std::size_t a) {
        Index s = surface.active[a];
        Vec3 u = Vec3::Zero(), v = Vec3::Zero();
        for (const Skin::Tie& tie : surface.skin.row(s)) {  // eq 25, and its rate
          Index i = tie.particle;
          u += tie.weight * (particles.displacement[i] + (F[i] - fit.projector(i)) * tie.arm);
          v += tie.weight * (particles.velocity[i] + F_rate[i] * tie.arm);
        }
        surface.position[s] = surface.rest[s] + u;
        surface.velocity[s] = v;
      },
      64);
}

void add_surface_force(const Surface& surface, const MovingLeastSquares& fit,
                       std::span<const Vec3> surface_force, std::span<Mat3> P, std::span<Vec3> force) {
  for (Index s : surface.active) {
    const Vec3& f = surface_force[s];
    if (f.isZero(0.0)) continue;
    for (const Skin::Tie& tie : surface.skin.row(s)) {
      force[tie.particle] += tie.weight * f;
      P[tie.particle] -= (tie.weight / fit.weight[tie.particle]) * f * tie.arm.transpose();
    }
  }
}

void vertex_normals(std::span<const Vec3> points, std::span<const Triangle> triangles,
                    std::span<Vec3> normals) {
  std::fill(normals.begin(), normals.end(), Vec3::Zero());
  for (const Triangle& t : triangles) {
    Vec3 edge[3];
    for (int c = 0; c < 3; ++c) edge[c] = points[t[(c + 1) % 3]] - points[t[c]];
    Vec3 normal = edge[0].cross(edge[1]);
    double twice_area = normal.norm();
    if (!(twice_area > 0.0)) continue;
    for (int c = 0; c < 3; ++c) {
      double angle = std::atan2(twice_area, -edge[c].dot(edge[(c + 2) % 3]));
      normals[t[c]] += angle / twice_area * normal;
    }
  }
  for (Vec3& normal : normals) {
    double length = normal.norm();
    normal = length > 0.0 ? Vec3(normal / length) : Vec3::UnitZ();
  }
}

}  // namespace deforma
