#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace deforma {

/// How the edges in a picture are smoothed.
struct Antialiasing {
  int samples = 1;  ///< multisampling: edges are found so many times per pixel, colours once
  int grid = 1;     ///< supersampling: everything is drawn so many times as fine along each axis

  bool operator==(const Antialiasing&) const = default;
};

/// "none", "4x multisampling", "2x2 supersampling", "2x2 supersampling of 4x multisampling"
std::string name_of(const Antialiasing& antialiasing);

/// What a picture may cost: how finely shadows are found and edges smoothed.
struct Detail {
  Antialiasing antialiasing = {4, 1};
  bool fits_machine = true;  ///< takes 2x2 supersampling instead where that is cheaper: see `antialiasing`
  int shadow_size = 1024;    ///< texels along the shadow map's edge; 0: no shadow
  int ground_size = 320;     ///< texels along the edge of the map of the ground's light
  int sky_size = 96;         ///< the same of the ground's ambient occlusion
  int body_taps = 12;        ///< in the shadow map, where a body is partly lit
  int blocker_taps = 14;     ///< of the ground: to find what throws a shadow
  int ground_taps = 16;      ///< and to find how much light passes it
  int sky_taps = 20;         ///< per ring of the ground's ambient occlusion
};

/// "draft", "standard", "final"
std::span<const std::string_view> quality_names();

/// @throws std::invalid_argument for a name that is none of these.
Detail detail_of(std::string_view quality);

}  // namespace deforma
