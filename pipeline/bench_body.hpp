#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/scene.hpp"

// What `deforma bench` and tests/bench measure: bodies as a scene file describes them, and nothing made for the purpose.
namespace deforma {

/// A box of particles moved by up to 0.2 spacings along each axis, turning slowly in space: elastic, with hourglass
/// control unless that is refused.
struct BenchBody {
  std::array<int, 3> across = {20, 20, 20};  ///< particles along each axis
  Gradient gradient = Gradient::linear;
  std::optional<double> links = std::nullopt;  ///< of a particle on the mean; a scene's own when absent
  bool hourglass = true;

  int particles() const { return across[0] * across[1] * across[2]; }
  /// The stiffness of hourglass control that comes with the fit.
  double usual_hourglass() const { return gradient == Gradient::quadratic ? 10.0 : 1.0; }
};

inline constexpr double bench_spacing = 1.0 / 16.0;  // [m]

/// Of its material.
inline constexpr double bench_young = 1e5;    // [Pa]
inline constexpr double bench_poisson = 0.3;  // -

/// The number of links that the core is measured with.
inline constexpr double bench_links = 37.0;

/// The box of so many particles that is nearest to a cube; a cube of nearly as many where it would be slender.
BenchBody bench_box(int particles);

/// One body of it, one corner at the origin.
Scene bench_scene(const BenchBody& body);

/// Two of them, one above the other with a gap of so many spacings, held at the far ends so that they stay there.
Scene bench_pair(const BenchBody& body, double gap);

/// Calls for an effect on a body of a scene. Values as `Parameters::set` takes them.
void add_effect(SceneBody& body, std::string_view name,
                const std::vector<std::pair<std::string_view, SettingValue>>& values = {});

}  // namespace deforma
