#include "assets/mesh.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include "assets/edges.hpp"

namespace deforma {

namespace {

using Eigen::Vector3d;

/// The root of a point's component; halves the way to it while going there.
std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t point) {
  while (parent[point] != point) {
    parent[point] = parent[parent[point]];
    point = parent[point];
  }
  return point;
}

/// Six times the volume of the tetrahedron to the middle. The corners are taken in an order of their places, so that
/// turning a triangle round turns the sign and nothing else: an inside-out mesh has its twin's volume to the last bit.
double six_volumes(Vector3d a, Vector3d b, Vector3d c) {
  double sign = 1.0;
  auto order = [&sign](Vector3d& p, Vector3d& q) {
    if (!std::lexicographical_compare(q.begin(), q.end(), p.begin(), p.end())) return;
    p.swap(q);
    sign = -sign;
  };
  order(a, b);
  order(b, c);
  order(a, b);
  return sign * a.dot(b.cross(c));
}

std::size_t count_components(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (const auto& t : mesh.triangles)
    for (int corner : {1, 2}) parent[root_of(parent, t[corner])] = root_of(parent, t[0]);
  std::vector<char> counted(mesh.points.size(), 0);
  std::size_t components = 0;
  for (const auto& t : mesh.triangles) {
    char& seen = counted[root_of(parent, t[0])];
    if (!seen) ++components;
    seen = 1;
  }
  return components;
}

}  // namespace

MeshFacts inspect(const Mesh& mesh) {
  check_indices(mesh);
  MeshFacts facts;
  if (mesh.triangles.empty()) return facts;

  facts.min.setConstant(std::numeric_limits<double>::infinity());
  facts.max = -facts.min;
  for (const auto& t : mesh.triangles)
    for (std::uint32_t corner : t) {
      facts.min = facts.min.cwiseMin(mesh.points[corner]);
      facts.max = facts.max.cwiseMax(mesh.points[corner]);
    }

  // Tetrahedra to the middle of the bounds, not to the origin: a body far away keeps its digits.
  Vector3d middle = 0.5 * (facts.min + facts.max);
  for (const auto& t : mesh.triangles) {
    Vector3d a = mesh.points[t[0]] - middle, b = mesh.points[t[1]] - middle, c = mesh.points[t[2]] - middle;
    facts.volume += six_volumes(a, b, c) / 6.0;
    facts.area += 0.5 * (b - a).cross(c - a).norm();
  }

  for (const Edge& edge : edges_of(mesh)) {
    int uses = edge.forward + edge.backward;
    if (uses == 1) ++facts.boundary_edges;
    if (uses > 2 || (uses == 2 && edge.forward != edge.backward)) ++facts.non_manifold_edges;
  }
  facts.components = count_components(mesh);
  return facts;
}

void transform(Mesh& mesh, const Eigen::Matrix3d& rotation, const Vector3d& scale,
               const Vector3d& translation) {
  if (!scale.allFinite() || (scale.array() == 0.0).any())
    throw std::invalid_argument(
        fmt::format("scale: expected three finite factors other than 0, found [{}, {}, {}]", scale.x(),
                    scale.y(), scale.z()));
  Eigen::Matrix3d linear = rotation * scale.asDiagonal();
  for (Vector3d& p : mesh.points) p = linear * p + translation;
  // A mirror image turns the triangles inside-out; turning each of them back keeps the outside outside.
  if (linear.determinant() < 0.0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

void subdivide(Mesh& mesh, int times) {
  check_indices(mesh);
  if (times < 0)
    throw std::invalid_argument(fmt::format("subdivide: expected 0 or more times, found {}", times));
  for (int round = 0; round < times; ++round) {
    if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max() / 8)
      throw std::invalid_argument(fmt::format(
          "subdivide: {} triangles can not be split again, found {} times", mesh.triangles.size(), times));
    std::unordered_map<std::uint64_t, std::uint32_t> middles;
    middles.reserve(mesh.triangles.size() * 3 / 2);
    auto middle = [&](std::uint32_t a, std::uint32_t b) {
      std::uint64_t key = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
      auto [entry, is_new] = middles.try_emplace(key, static_cast<std::uint32_t>(mesh.points.size()));
      if (is_new) mesh.points.emplace_back(0.5 * (mesh.points[a] + mesh.points[b]));
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    finer.reserve(mesh.triangles.size() * 4);
    for (const auto& [a, b, c] : mesh.triangles) {
      std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.push_back({a, ab, ca});
      finer.push_back({ab, b, bc});
      finer.push_back({ca, bc, c});
      finer.push_back({ab, bc, ca});
    }
    mesh.triangles = std::move(finer);
  }
}

}  // namespace deforma
