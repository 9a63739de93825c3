#include "pipeline/coloring.hpp"

namespace deforma {

std::optional<Coloring> Coloring::of(const Scene& scene) {
  const OutputSpec& output = scene.output;
  if (output.color_by == "none") return std::nullopt;
  const FieldInfo& field = find_field(output.color_by);
  const bool has_middle = field.kind == FieldKind::det_f;
  const ColorMap& map = find_color_map(output.color_map != "automatic" ? output.color_map
                                       : has_middle                    ? "coolwarm"
                                                                       : "viridis");
  Coloring coloring{&field, {&map, 0.0, 1.0}, !output.color_range, {field, map.diverging}};
  if (output.color_range) {
    coloring.scale.low = (*output.color_range)[0];
    coloring.scale.high = (*output.color_range)[1];
  }
  return coloring;
}

void Coloring::add(const Scene& scene, const State& state, const Snapshot& snapshot) {
  const auto part = [](const std::vector<float>& all, const Range& range) {
    return all.empty() ? std::span<const float>() : std::span(all).subspan(range.begin, range.size());
  };
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    if (!scene.bodies[b].visible) continue;
    values.add(part(snapshot.point_values, state.bodies[b].vertices));
    values.add(part(snapshot.particle_values, state.bodies[b].particles));
  }
}

ColorBar Coloring::bar() const {
  return {scale, std::string(field->title), std::string(field->unit), field->least < scale.low};
}

void Coloring::settle() {
  if (!automatic) return;
  const auto [low, high] = values.range();
  scale.low = low;
  scale.high = high;
}

}  // namespace deforma
