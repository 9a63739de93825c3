#include "sim/contact_search.hpp"

#include <algorithm>
#include <limits>

#include "sim/contact_law.hpp"
#include "sim/parallel.hpp"

namespace deforma {
namespace {

// Lengths in spacings.
constexpr double obstacle_margin = 0.5;   // how far obstacles are looked for
constexpr double body_margin = 0.25;      // how far bodies move before neighbours are sought again
constexpr double own_neighborhood = 2.0;  // surface closer at rest does not count as touching itself

struct NearObstacles {
  std::vector<std::vector<Index>> lists;  // of each point
  double far;                             // how far away the closest of those not listed is [m]
};

NearObstacles find_near_obstacles(std::size_t count, const std::function<Vec3(std::size_t)>& point,
                                  double margin, std::span<const ObstacleMotion> obstacles) {
  NearObstacles near{std::vector<std::vector<Index>>(count), std::numeric_limits<double>::infinity()};
  std::vector<double> far(count, near.far);
  parallel_for_each(
      count,
      [&](std::size_t k) {
        const Vec3 p = point(k);
        for (Index o = 0; o < obstacles.size(); ++o) {
          const double clearance = obstacles[o].clearance(p);
          if (clearance <= margin)
            near.lists[k].push_back(o);
          else
            far[k] = std::min(far[k], clearance);
        }
      },
      64);
  for (double distance : far) near.far = std::min(near.far, distance);
  return near;
}

}  // namespace

ContactPlaces find_contact_places(const State& state, std::span<const Vec3> points,
                                  std::span<const ContactSide> sides,
                                  std::span<const ObstacleMotion> obstacles,
                                  const std::function<bool(Index vertex)>& touching) {
  ContactPlaces places;
  places.slack = std::numeric_limits<double>::infinity();
  std::vector<std::vector<NearSurface>> surfaces(points.size());
  for (const ContactSide& a : sides)
    for (const ContactSide& b : sides) {
      const bool self = &a == &b;
      if (self ? !a.self : !(a.bodies && b.bodies)) continue;
      const double spacing = std::min(state.bodies[a.body].spacing, state.bodies[b.body].spacing);
      std::vector<NearSurface> found;
      const double far = find_near_surfaces(
          state, points, a.body, b.body,
          {deepest_contact * spacing, body_margin * spacing, own_neighborhood * spacing}, touching, found);
      places.slack = std::min(places.slack, far);
      for (NearSurface& surface : found) surfaces[surface.vertex].push_back(std::move(surface));
    }
  for (Index k = 0; k < sides.size(); ++k) {
    const Body& body = state.bodies[sides[k].body];
    const double margin = obstacle_margin * body.spacing, shell = Penalty::shell * body.spacing;
    NearObstacles vertices = find_near_obstacles(
        body.vertices.size(), [&](std::size_t l) { return points[body.vertices.begin + l]; }, margin,
        obstacles);
    NearObstacles particles = find_near_obstacles(
        body.particles.size(),
        [&](std::size_t l) { return state.particles.position(body.particles.begin + l); }, margin, obstacles);
    places.slack = std::min({places.slack, vertices.far - shell, particles.far});
    for (Index l = 0; l < body.vertices.size(); ++l) {
      const Index s = body.vertices.begin + l;
      if (!vertices.lists[l].empty() || !surfaces[s].empty())
        places.vertices.push_back({s, k, std::move(vertices.lists[l]), std::move(surfaces[s])});
    }
    for (Index l = 0; l < body.particles.size(); ++l)
      if (!particles.lists[l].empty())
        places.particles.push_back({body.particles.begin + l, k, std::move(particles.lists[l])});
  }
  return places;
}

}  // namespace deforma
