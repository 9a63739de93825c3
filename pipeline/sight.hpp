#pragma once

#include <optional>
#include <span>
#include <vector>

#include "assets/mesh.hpp"
#include "assets/sample.hpp"
#include "sim/particles.hpp"
#include "sim/types.hpp"

namespace deforma {

/// Answers for the links of every body whether their two ends see each other through its inside, so that none
/// joins across a gap or between separate pieces. Convex bodies need no answer and cost none.
class Sight {
 public:
  /// @param meshes one per body
  Sight(std::span<const Mesh> meshes, std::span<const Body> bodies);

  /// Whether any body needs to be asked.
  bool needed() const;

  /// @param a, b points in the body's rest shape [m]
  bool operator()(Index body, const Vec3& a, const Vec3& b) const;

 private:
  std::vector<std::optional<Visibility>> visibility_;  ///< per body, empty where convex
};

/// Whether a mesh is one closed piece that bends outwards at every edge.
bool is_convex(const Mesh& mesh);

}  // namespace deforma
