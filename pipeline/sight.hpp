#pragma once

#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "assets/mesh.hpp"
#include "assets/sample.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Answers for the links of every body whether their two ends see each other through its inside, so that none
/// joins across a gap or between separate pieces. Convex bodies need no answer and cost none.
class Sight {
 public:
  /// @param meshes one per body of the state
  Sight(const State& state, std::span<const Mesh> meshes);

  /// Whether any body needs to be asked.
  bool needed() const;

  /// @param a any point, @param b exactly the rest position of a particle [m]
  bool operator()(const Vec3& a, const Vec3& b) const;

 private:
  struct Hash {
    std::size_t operator()(const Vec3& point) const;
  };
  std::vector<std::optional<Visibility>> visibility_;  ///< per body, empty where convex
  std::unordered_map<Vec3, Index, Hash> body_;         ///< of each particle, by its rest position
};

/// Whether a mesh is one closed piece that bends outwards at every edge.
bool is_convex(const Mesh& mesh);

}  // namespace deforma
