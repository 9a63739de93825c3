#pragma once

#include <optional>

#include "pipeline/drawing.hpp"
#include "pipeline/scene.hpp"
#include "pipeline/value_range.hpp"
#include "render/color_bar.hpp"
#include "render/color_map.hpp"
#include "sim/fields.hpp"

namespace deforma {

/// How the bodies of a scene are coloured by a field: with one scale for the whole run.
struct Coloring {
  const FieldInfo* field;
  ColorScale scale;   ///< its ends are settled only when every frame is known, if they are automatic
  bool automatic;     ///< whether the scene left the range open
  ValueRange values;  ///< of all that was drawn

  /// None when the scene asks for none. The map, if open, is a diverging one for what has a middle at rest.
  static std::optional<Coloring> of(const Scene& scene);

  /// Takes account of what a frame shows of visible bodies.
  void add(const Scene& scene, const State& state, const Snapshot& snapshot);

  /// The legend, with the range as it is now.
  ColorBar bar() const;

  /// Finds the range, if it is automatic, from the frames so far.
  void settle();
};

}  // namespace deforma
