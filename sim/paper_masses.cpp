#include "sim/paper_masses.hpp"

#include <cmath>

namespace deforma {

void give_paper_masses(State& state, Index body, double density, const NeighborhoodSettings& settings) {
  Particles& particles = state.particles;
  const Range range = state.bodies[body].particles;
  for (Index i = range.begin; i < range.end; ++i)  // eq 10
    particles.mass[i] = density * std::pow(state.links.support[i] / settings.support, 3);
  for (Index i = range.begin; i < range.end; ++i) {
    const double h = state.links.support[i];
    double sum = particles.mass[i] * kernel_weight(settings.kernel, 0.0, h);
    const Range row = state.links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      const Index j = state.links.links[l].j;
      const double r = (particles.rest[j] - particles.rest[i]).norm();
      sum += particles.mass[j] * kernel_weight(settings.kernel, r, 0.5 * (h + state.links.support[j]));
    }
    particles.volume[i] = particles.mass[i] / sum;
  }
}

}  // namespace deforma
