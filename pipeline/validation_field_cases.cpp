#include <cmath>
#include <memory>

#include "pipeline/validation_case.hpp"
#include "pipeline/validation_probe.hpp"

namespace deforma {

namespace {

/// The effects of a scene's only body, made anew for another state.
std::vector<std::unique_ptr<Effect>> effects_of(const Scene& scene, State& state) {
  std::vector<EffectRequest> requests;
  for (const SceneEffect& effect : scene.bodies.front().effects)
    requests.push_back({effect.info->name, {0, effect.parameters, effect.where}});
  return make_effects(state, requests);
}

constexpr int patch_frame = 3;  // layers: the widest support of the quadratic fit

/// A cube whose outer layers are held in an affine deformation, so thick that every particle that is solved for has its
/// whole neighbourhood.
Measured measure_patch(const Scene& scene, World& world, const ValidationVariant& variant) {
  Mat3 gradient;  // no symmetry: a transposed or rotated one would show
  gradient << 1.0, 2.0, -1.0, 0.5, -1.5, 1.0, -2.0, 0.7, 0.8;
  gradient *= 1e-4;
  State state = world.solver->state();
  const double free_half_width = 0.5 * variant.n * state.bodies.front().spacing;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3& X = state.particles.rest[i];
    // A jittered particle may lie up to 0.2 spacings outside its cell's middle: it is solved for as long as it is inside.
    state.fixed[i] = X.cwiseAbs().maxCoeff() > free_half_width;
    if (state.fixed[i]) state.particles.displacement[i] = gradient * X;
  }
  auto effects = effects_of(scene, state);
  Solver solver(std::move(state), std::move(effects), {});
  settle(solver, 1e-12);
  const State& now = solver.state();
  double error = 0.0;
  for (std::size_t i = 0; i < now.size(); ++i)
    if (!now.fixed[i])
      error = std::max(error, (now.F[i] - Mat3::Identity() - gradient).norm() / gradient.norm());
  return {{{"strain error", error}}, largest_strain(now)};
}

ValidationCase patch() {
  return {
      .name = "patch",
      .summary =
          "a cube whose outer layers are held in an affine deformation; the n^3 particles inside find their "
          "equilibrium",
      .sizes = {4, 6, 8, 10},
      .small = true,
      .weight = 30.0,
      .scene =
          [](const ValidationVariant& variant) {
            ValidationVariant framed = variant;
            framed.n += 2 * patch_frame;
            return cube_scene({.width = static_cast<double>(framed.n)}, framed);
          },
      .mesh = {},
      .measure = measure_patch};
}

ValidationCase cook() {
  return {
      .name = "cook",
      .summary = "Cook's membrane: a tapered sheet of one layer, 16/n thick, sheared at its end",
      .sizes = {4, 6, 8, 10},
      .small = true,
      .weight = 1.0,
      .scene = cook_scene,
      .mesh = cook_mesh,
      .measure = [](const Scene&, World& world, const ValidationVariant&) -> Measured {
        settle(*world.solver);
        const Surface& surface = world.solver->state().surface;
        std::vector<Vec3> moved(surface.size());
        world.solver->deform(moved);
        const Vec3 middle(48.0, 52.0, 0.0);
        std::size_t nearest = 0;
        for (std::size_t s = 0; s < moved.size(); ++s)
          if ((surface.rest[s] - middle).head<2>().norm() < (surface.rest[nearest] - middle).head<2>().norm())
            nearest = s;
        return {{{"1e4 u_y(48, 52)", 1e4 * (moved[nearest] - surface.rest[nearest]).y()}},
                largest_strain(world.solver->state())};
      }};
}

}  // namespace

std::vector<ValidationCase> field_validation_cases() { return {patch(), cook()}; }

}  // namespace deforma
