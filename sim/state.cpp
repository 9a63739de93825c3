#include "sim/state.hpp"

#include "sim/consistency.hpp"

namespace deforma {

void prepare_state(State& state, const NeighborhoodSettings& settings, const LinkFilter& link_allowed,
                   const LinkFilter& tie_allowed, Gradient gradient) {
  state.links = build_neighborhood(state.particles, state.bodies, settings, link_allowed);
  refit(state, gradient);
  Surface& surface = state.surface;
  surface.area = vertex_areas(surface.rest, surface.triangles);
  surface.skin = bind_skin(state.particles, state.bodies, state.links, surface.rest, tie_allowed);
  surface.position = surface.rest;
  surface.velocity.assign(surface.size(), Vec3::Zero());
  state.F.resize(state.size());
  for (std::size_t i = 0; i < state.size(); ++i) state.F[i] = state.fit.projector(i);
  state.fixed.assign(state.size(), 0);
}

void refit(State& state, Gradient gradient) {
  CompleteNeighborhoods complete;
  if (gradient == Gradient::quadratic)
    complete = complete_neighborhoods(state.particles, state.bodies, state.links, state.surface);
  state.fit = fit_moving_least_squares(state.particles, state.links, gradient, complete.particles);
  state.fit.consistency.left_out = complete.left_out;
}

}  // namespace deforma
