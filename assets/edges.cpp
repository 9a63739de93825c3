#include "assets/edges.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

namespace deforma {

std::vector<Edge> edges_of(const Mesh& mesh) {
  std::vector<Edge> uses;
  uses.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      std::uint32_t from = t[i], to = t[(i + 1) % 3];
      uses.push_back(from < to ? Edge{from, to, 1, 0} : Edge{to, from, 0, 1});
    }
  std::sort(uses.begin(), uses.end(),
            [](const Edge& l, const Edge& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; });
  std::vector<Edge> edges;
  for (const Edge& use : uses) {
    if (edges.empty() || edges.back().a != use.a || edges.back().b != use.b)
      edges.push_back({use.a, use.b, 0, 0});
    edges.back().forward += use.forward;
    edges.back().backward += use.backward;
  }
  return edges;
}

void check_indices(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (!mesh.points[i].allFinite())
      throw std::invalid_argument(fmt::format("mesh: point {} is not finite", i));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::uint32_t corner : mesh.triangles[i])
      if (corner >= mesh.points.size())
        throw std::invalid_argument(fmt::format("mesh: triangle {} names point {}, expected below {}", i,
                                                corner, mesh.points.size()));
}

}  // namespace deforma
