#include "assets/shapes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace deforma {

namespace {

using Eigen::Vector3d;
using std::numbers::pi;

void require_length(std::string_view shape, std::string_view what, double value) {
  if (!std::isfinite(value) || value <= 0.0)
    throw std::invalid_argument(fmt::format("{}: {}: expected above 0 m, found {}", shape, what, value));
}

void require_lengths(std::string_view shape, std::string_view what, const Vector3d& values) {
  if (!values.allFinite() || values.minCoeff() <= 0.0)
    throw std::invalid_argument(fmt::format("{}: {}: expected three lengths above 0 m, found [{}, {}, {}]",
                                            shape, what, values.x(), values.y(), values.z()));
}

void require_count(std::string_view shape, std::string_view what, int value, int least) {
  if (value < least)
    throw std::invalid_argument(
        fmt::format("{}: {}: expected {} or more, found {}", shape, what, least, value));
}

std::uint32_t index(std::size_t value) { return static_cast<std::uint32_t>(value); }

/// Two triangles over the quad a b c d (counter-clockwise), cut along one diagonal or the other.
void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
              bool other_diagonal) {
  if (other_diagonal) {
    mesh.triangles.push_back({a, b, d});
    mesh.triangles.push_back({b, c, d});
  } else {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
}

/// Quads between two rings of as many points; `upper` lies to the left when walking along `lower`.
void add_band(Mesh& mesh, std::uint32_t lower, std::uint32_t upper, int segments, bool shift) {
  for (int i = 0; i < segments; ++i) {
    std::uint32_t here = index(i), next = index((i + 1) % segments);
    add_quad(mesh, lower + here, lower + next, upper + next, upper + here, (i % 2 == 1) != shift);
  }
}

/// A surface with the connections of an octahedron whose edges are cut into n cells: rings of 4 (n - |k|) points for
/// k = -n ... n. `place(k, i)` puts point i of ring k.
template <typename Place>
Mesh make_octahedral(int n, const Place& place) {
  Mesh mesh;
  std::map<int, std::uint32_t> first;
  auto points_in = [n](int k) { return std::max(1, 4 * (n - std::abs(k))); };
  for (int k = -n; k <= n; ++k) {
    first[k] = index(mesh.points.size());
    for (int i = 0; i < points_in(k); ++i) mesh.points.push_back(place(k, i));
  }
  for (int k = -n; k < n; ++k) {
    // The longer ring of the two carries the triangles' bases; each quarter of it has one cell more.
    bool upwards = k >= 0;
    int wide = upwards ? k : k + 1, narrow = upwards ? k + 1 : k;
    int cells = n - std::abs(wide);
    for (int quarter = 0; quarter < 4; ++quarter)
      for (int i = 0; i < cells; ++i) {
        auto outer = [&](int j) { return first[wide] + index((quarter * cells + j) % points_in(wide)); };
        auto inner = [&](int j) {
          return first[narrow] + index((quarter * (cells - 1) + j) % points_in(narrow));
        };
        auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
          mesh.triangles.push_back(upwards ? std::array{a, b, c} : std::array{a, c, b});
        };
        add(outer(i), outer(i + 1), inner(i));
        if (i + 1 < cells) add(outer(i + 1), inner(i + 1), inner(i));
      }
  }
  return mesh;
}

}  // namespace

Mesh make_box(const Vector3d& size, int resolution) {
  require_lengths("box", "size", size);
  require_count("box", "resolution", resolution, 1);
  std::array<int, 3> cells;
  for (int axis = 0; axis < 3; ++axis)
    cells[axis] = std::max(1, static_cast<int>(std::lround(resolution * size[axis] / size.maxCoeff())));

  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  auto point = [&](const std::array<int, 3>& at) {
    auto [entry, is_new] = known.try_emplace(at, index(mesh.points.size()));
    if (is_new) {
      Vector3d p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = size[axis] * (double(at[axis]) / cells[axis] - 0.5);
      mesh.points.push_back(p);
    }
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int end : {0, 1}) {
      int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < cells[u]; ++i)
        for (int j = 0; j < cells[v]; ++j) {
          std::array<std::uint32_t, 4> corner;
          for (int c = 0; c < 4; ++c) {
            std::array<int, 3> at;
            at[axis] = end * cells[axis];
            at[u] = i + (c == 1 || c == 2);
            at[v] = j + (c >= 2);
            corner[c] = point(at);
          }
          if (end == 0) std::swap(corner[1], corner[3]);
          add_quad(mesh, corner[0], corner[1], corner[2], corner[3], (i + j) % 2 == 1);
        }
    }
  return mesh;
}

Mesh make_sphere(double radius, int resolution) {
  require_length("sphere", "radius", radius);
  require_count("sphere", "resolution", resolution, 1);
  // Rings at even angles, points at even angles within a ring: triangles differ by at most pi / 2 in length, where
  // an octahedron blown up would differ by more than two.
  return make_octahedral(resolution, [&](int k, int i) -> Vector3d {
    int points = 4 * (resolution - std::abs(k));
    if (points == 0) return {0, 0, std::copysign(radius, double(k))};
    double latitude = 0.5 * pi * k / resolution, longitude = 2.0 * pi * i / points;
    return radius * Vector3d(std::cos(latitude) * std::cos(longitude),
                             std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  });
}

Mesh make_ellipsoid(const Vector3d& radii, int resolution) {
  require_lengths("ellipsoid", "radii", radii);
  require_count("ellipsoid", "resolution", resolution, 1);
  Mesh mesh = make_sphere(1.0, resolution);
  for (Vector3d& p : mesh.points) p = p.cwiseProduct(radii);
  return mesh;
}

Mesh make_octahedron(double radius, int resolution) {
  require_length("octahedron", "radius", radius);
  require_count("octahedron", "resolution", resolution, 1);
  return make_octahedral(resolution, [&](int k, int i) -> Vector3d {
    int cells = resolution - std::abs(k);
    double step = radius / resolution;
    if (cells == 0) return {0, 0, step * k};
    int quarter = i / cells, along = i % cells;
    double a = step * (cells - along), b = step * along, z = step * k;
    if (quarter == 0) return {a, b, z};
    if (quarter == 1) return {-b, a, z};
    if (quarter == 2) return {-a, -b, z};
    return {b, -a, z};
  });
}

Mesh make_torus(double radius, double tube_radius, int segments, int rings) {
  require_length("torus", "tube_radius", tube_radius);
  require_length("torus", "radius", radius);
  if (tube_radius >= radius)
    throw std::invalid_argument(
        fmt::format("torus: tube_radius: expected below the radius {} m, found {}", radius, tube_radius));
  require_count("torus", "segments", segments, 3);
  require_count("torus", "rings", rings, 3);
  Mesh mesh;
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < segments; ++i) {
      double around = 2.0 * pi * i / segments, tube = 2.0 * pi * j / rings;
      double reach = radius + tube_radius * std::cos(tube);
      mesh.points.emplace_back(reach * std::cos(around), reach * std::sin(around),
                               tube_radius * std::sin(tube));
    }
  for (int j = 0; j < rings; ++j)
    add_band(mesh, index(j * segments), index((j + 1) % rings * segments), segments, j % 2 == 1);
  return mesh;
}

Mesh make_cylinder(double radius, double height, int segments, int rings) {
  require_length("cylinder", "radius", radius);
  require_length("cylinder", "height", height);
  require_count("cylinder", "segments", segments, 3);
  require_count("cylinder", "rings", rings, 2);

  // Of `rings`, each cap takes as many as bring the steps along the side and across the caps closest to each other;
  // the innermost ring lies half a step from the axis.
  int cap = 0;
  double best = std::numeric_limits<double>::infinity();
  for (int candidate = 0; rings - 2 * candidate >= 2; ++candidate) {
    double side_step = height / (rings - 2 * candidate - 1), cap_step = radius / (candidate + 0.5);
    double uneven = std::abs(std::log(side_step / cap_step));
    if (uneven < best) {
      best = uneven;
      cap = candidate;
    }
  }

  Mesh mesh;
  auto add_ring = [&](double ring_radius, double z) {
    for (int i = 0; i < segments; ++i) {
      double angle = 2.0 * pi * i / segments;
      mesh.points.emplace_back(ring_radius * std::cos(angle), ring_radius * std::sin(angle), z);
    }
  };
  auto cap_radius = [&](int ring) { return radius * (1.0 - ring / (cap + 0.5)); };
  int side = rings - 2 * cap;
  for (int ring = cap; ring >= 1; --ring) add_ring(cap_radius(ring), -0.5 * height);
  for (int ring = 0; ring < side; ++ring) add_ring(radius, height * (double(ring) / (side - 1) - 0.5));
  for (int ring = 1; ring <= cap; ++ring) add_ring(cap_radius(ring), 0.5 * height);

  for (int ring = 0; ring + 1 < rings; ++ring)
    add_band(mesh, index(ring * segments), index((ring + 1) * segments), segments, ring % 2 == 1);

  // A zigzag across the innermost rings: no triangle longer than the ring is wide, and no crowded point.
  std::uint32_t top = index((rings - 1) * segments);
  int low = 0, high = segments - 1;
  for (bool take_low = true; high - low >= 2; take_low = !take_low) {
    std::uint32_t a = index(low), b = index(high), c = index(take_low ? low + 1 : high - 1);
    mesh.triangles.push_back({top + a, top + c, top + b});
    mesh.triangles.push_back({a, b, c});
    take_low ? ++low : --high;
  }
  return mesh;
}

}  // namespace deforma
