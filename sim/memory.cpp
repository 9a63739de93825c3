#include "sim/memory.hpp"

namespace deforma {

std::size_t strain_bytes(const State& state) {
  const Neighborhood& links = state.links;
  const MovingLeastSquares& fit = state.fit;
  return bytes_of(links.links) + bytes_of(links.start) + bytes_of(links.support) + bytes_of(links.places) +
         bytes_of(links.ahead) + bytes_of(fit.inverse) + bytes_of(fit.projectors) + bytes_of(fit.rank) +
         bytes_of(fit.trace) + bytes_of(fit.weight) + bytes_of(fit.there) + bytes_of(fit.back) +
         bytes_of(fit.sums) + bytes_of(state.F) + bytes_of(state.F_rate);
}

std::size_t surface_bytes(const Surface& surface) {
  return bytes_of(surface.rest) + bytes_of(surface.triangles) + bytes_of(surface.body) +
         bytes_of(surface.area) + bytes_of(surface.position) + bytes_of(surface.velocity) +
         bytes_of(surface.active) + bytes_of(surface.skin.ties) + bytes_of(surface.skin.start);
}

std::size_t particle_bytes(const Particles& particles) {
  return bytes_of(particles.rest) + bytes_of(particles.displacement) + bytes_of(particles.velocity) +
         bytes_of(particles.mass) + bytes_of(particles.volume) + bytes_of(particles.cells) +
         bytes_of(particles.body);
}

}  // namespace deforma
