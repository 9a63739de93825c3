#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "assets/mesh.hpp"

namespace deforma {

/// The triangles of a mesh in a binary tree of boxes, halved at the median: the same for the same mesh every time.
/// Safe to query from several threads.
class MeshTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0;  ///< triangles [first, first + count), in tree order
    std::uint32_t count = 0;
    std::uint32_t right = 0;  ///< second child; the first one follows its parent. 0: a leaf
  };
  struct Triangle {
    std::array<Eigen::Vector3d, 3> corner;  ///< [m]
    std::array<std::uint32_t, 3> point;     ///< their indices in the mesh
  };

  /// @throws std::invalid_argument for a triangle that names a missing point, or a point that is not finite.
  explicit MeshTree(const Mesh& mesh);

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

  /// Visits the tree from the top: `enter(node number)` says whether to go on below it, `visit(triangle)` is called
  /// for the triangles of every leaf entered and may return false to end the walk.
  template <typename Enter, typename Visit>
  void walk(const Enter& enter, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, 64> waiting;  // the median halves: never deeper than 32
    int depth = 0;
    waiting[depth++] = 0;
    while (depth > 0) {
      std::uint32_t at = waiting[--depth];
      if (!enter(at)) continue;
      const Node& node = nodes_[at];
      if (node.right != 0) {
        waiting[depth++] = node.right;
        waiting[depth++] = at + 1;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
        if (!visit(triangles_[i])) return;
    }
  }

  /// Distance from a point to the nearest triangle [m], or `limit` if that is less.
  double distance(const Eigen::Vector3d& from, double limit) const;

  /// The place on the triangles nearest to a point, if it is nearer than `limit` [m].
  std::optional<Eigen::Vector3d> closest(const Eigen::Vector3d& from, double limit) const;

 private:
  std::uint32_t build(std::uint32_t first, std::uint32_t count);

  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
};

}  // namespace deforma
