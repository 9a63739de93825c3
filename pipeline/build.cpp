#include "pipeline/build.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "pipeline/build_body.hpp"
#include "pipeline/overlap.hpp"
#include "pipeline/sight.hpp"
#include "pipeline/user_error.hpp"
#include "sim/kernel.hpp"
#include "sim/merge.hpp"
#include "sim/paper_masses.hpp"
#include "sim/point_tree.hpp"

namespace deforma {

namespace {

Curve<Vec3> in_radians(const Curve<Vec3>& degrees) {
  std::vector<Curve<Vec3>::Key> keys = degrees.keys();
  for (auto& [time, rotation] : keys) rotation *= radians_per_degree;
  return Curve<Vec3>(std::move(keys));
}

std::vector<Obstacle> make_obstacles(const Scene& scene) {
  std::vector<Obstacle> obstacles;
  for (const SceneObstacle& o : scene.obstacles) {
    try {
      obstacles.push_back(
          {o.name, o.info->make(o.parameters, o.mesh_file), o.position, in_radians(o.rotation), o.friction});
    } catch (const std::exception& error) {
      throw UserError(fmt::format("{}: {}", o.where, error.what()));
    }
  }
  if (scene.ground && scene.ground->solid)
    obstacles.push_back(
        {"ground", PlaneShape{}, Vec3(0, 0, scene.ground->height), Vec3(0, 0, 0), scene.ground->friction});
  return obstacles;
}

/// The tables of one effect that hold for a body: its own, else the world's unless it refuses them.
std::vector<const SceneEffect*> tables_of(const Scene& scene, const SceneBody& body, const EffectInfo& info) {
  std::vector<const SceneEffect*> tables;
  for (const SceneEffect& effect : body.effects)
    if (effect.info->name == info.name) tables.push_back(&effect);
  bool refused = std::find(body.without.begin(), body.without.end(), info.name) != body.without.end();
  if (!tables.empty() || refused) return tables;
  for (const SceneEffect& effect : scene.world)
    if (effect.info->name == info.name) tables.push_back(&effect);
  return tables;
}

std::vector<std::unique_ptr<Effect>> make_effects(const Scene& scene, State& state) {
  std::vector<EffectRequest> requests;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    for (const EffectInfo& info : effect_registry())
      for (const SceneEffect* effect : tables_of(scene, scene.bodies[b], info))
        requests.push_back({info.name, {static_cast<Index>(b), effect->parameters, effect->where}});
  try {
    return make_effects(state, requests);
  } catch (const std::invalid_argument& error) {
    throw UserError(error.what());
  }
}

/// Where each body's contact is asked for; empty for one without.
std::vector<std::string> contacts_of(const Scene& scene) {
  std::vector<std::string> where;
  for (const SceneBody& body : scene.bodies) {
    std::vector<const SceneEffect*> tables = tables_of(scene, body, find_effect("contact"));
    where.push_back(tables.empty() ? "" : tables.front()->where);
  }
  return where;
}

void warn_of_missing_contact(const Scene& scene, const State& state, std::vector<std::string>& warnings) {
  if (state.obstacles.empty()) return;
  const EffectInfo& contact = find_effect("contact");
  for (const SceneBody& body : scene.bodies)
    if (tables_of(scene, body, contact).empty())
      warnings.push_back(fmt::format("{}: falls through every obstacle: it has no 'contact'", body.name));
}

std::vector<BodyFacts> facts_of(const State& state) {
  std::vector<BodyFacts> facts;
  for (const Body& body : state.bodies) {
    BodyFacts f{body.name, body.particles.size(), body.vertices.size(), body.triangles.size()};
    f.spacing = body.spacing;
    for (Index i = body.particles.begin; i < body.particles.end; ++i) {
      f.mass += state.particles.mass[i];
      f.volume += state.particles.volume[i];
      f.links += state.links.row(i).size();
    }
    f.links /= 2;  // rows hold every pair in both directions
    facts.push_back(f);
  }
  return facts;
}

/// Fewer neighbours are more exact, but the quadratic fit has nine coefficients to find.
NeighborhoodSettings neighborhood_settings(const SolverSpec& spec) {
  const bool quadratic = gradient_from_name(spec.gradient) == Gradient::quadratic;
  return {kernel_from_name(spec.kernel), spec.neighbors.value_or(quadratic ? 30 : 18),
          spec.support.value_or(quadratic ? 1.7 : 1.5), spec.portable};
}

/// About what the solver holds for each particle [bytes]; measured within a fifth of what `deforma check` tells.
double memory_per_particle(const SolverSpec& spec) {
  const NeighborhoodSettings settings = neighborhood_settings(spec);
  // The k nearest of evenly spread points are on average 3/4 as far away as the k-th: so many fill the support.
  const double links = settings.neighbors * std::pow(0.75 * settings.support, 3);
  const bool quadratic = gradient_from_name(spec.gradient) == Gradient::quadratic;
  const auto per_link = static_cast<double>(sizeof(Link) + (quadratic ? 2 * sizeof(GradientLink) : 0));
  constexpr double without_links = 700.0;
  return without_links + links * per_link;
}

void merge_particles(State& state, std::vector<std::string>& warnings) {
  std::vector<std::size_t> lost = merge_coincident(state.particles, state.bodies);
  for (std::size_t b = 0; b < lost.size(); ++b)
    if (lost[b] > 0)
      warnings.push_back(
          fmt::format("{}: {} particles stand where another one does: merged with it, {} are left; their "
                      "masses and volumes are summed",
                      state.bodies[b].name, lost[b], state.bodies[b].particles.size()));
}

/// For the bodies that ask for them.
void give_paper_masses(const Scene& scene, State& state, std::vector<std::string>& warnings) {
  bool any = false;
  for (Index b = 0; b < state.bodies.size(); ++b) {
    if (scene.bodies[b].mass_rule != "paper") continue;
    const Range range = state.bodies[b].particles;
    auto weight = [&] {
      return std::accumulate(state.particles.mass.begin() + range.begin,
                             state.particles.mass.begin() + range.end, 0.0);
    };
    const double before = weight();
    give_paper_masses(state, b, scene.bodies[b].density, neighborhood_settings(scene.solver));
    warnings.push_back(fmt::format(
        "{}: mass_rule 'paper' makes it weigh {:.4g} kg, its density times its volume is {:.4g} kg",
        state.bodies[b].name, weight(), before));
    any = true;
  }
  if (any) refit(state, gradient_from_name(scene.solver.gradient));
}

/// The default number of neighbours is clipped to those there are; one that was asked for is kept or refused.
void check_neighbors(const Scene& scene, const State& state) {
  if (!scene.solver.neighbors) return;
  for (const Body& body : state.bodies) {
    Index others = body.particles.size() - 1;
    if (static_cast<Index>(*scene.solver.neighbors) <= others) continue;
    std::string allowed = others < 3 ? "too few for any number" : fmt::format("expected 3 to {}", others);
    throw UserError(
        fmt::format("{}: solver.neighbors: found {}, but a particle of '{}' has {} others, {}; "
                    "without this key it is as many as there are",
                    scene.file.string(), *scene.solver.neighbors, body.name, others, allowed));
  }
}

/// Particles whose links the body's shape forbids are no fault of the support, nor is the only one of a body.
void check_support(const Scene& scene, const State& state) {
  if (!scene.solver.support) return;
  for (const Body& body : state.bodies) {
    std::span<const Vec3> rest =
        std::span(state.particles.rest).subspan(body.particles.begin, body.particles.size());
    PointTree tree(rest);
    std::size_t lonely = 0;
    double needed = 0.0;
    std::vector<PointTree::Found> two;
    for (Index i = body.particles.begin; i < body.particles.end; ++i) {
      if (state.links.row(i).size() > 0 || body.particles.size() < 2) continue;
      tree.nearest(state.particles.rest[i], 2, two);
      const auto [nearest, distance] = two[1];
      double reach = 0.5 * (state.links.support[i] + state.links.support[body.particles.begin + nearest]);
      if (distance < reach) continue;
      ++lonely;
      needed = std::max(needed, *scene.solver.support * distance / reach);
    }
    if (lonely > 0)
      throw UserError(fmt::format(
          "{}: solver.support: {} leaves {} of the {} particles of '{}' without a "
          "neighbour, expected above {:.3g}",
          scene.file.string(), *scene.solver.support, lonely, body.particles.size(), body.name, needed));
  }
}

SolverSettings solver_settings(const SolverSpec& spec) {
  return {spec.integrator == "velocity_verlet" ? Integrator::velocity_verlet : Integrator::symplectic_euler,
          spec.step_fraction, spec.max_step};
}

}  // namespace

World build(const Scene& scene) {
  World world;
  State state;
  std::vector<Mesh> meshes;
  for (const SceneBody& body : scene.bodies) {
    meshes.push_back(make_body_mesh(body, world.warnings));
    append_body(state, body, meshes.back(), memory_per_particle(scene.solver), world.warnings);
  }
  merge_particles(state, world.warnings);
  const Gradient gradient = gradient_from_name(scene.solver.gradient);
  if (gradient == Gradient::linear) std::vector<Cell>().swap(state.particles.cells);  // nothing asks for them
  check_neighbors(scene, state);
  state.obstacles = make_obstacles(scene);

  auto sight = std::make_shared<const Sight>(meshes, state.bodies);
  LinkFilter filter;
  if (sight->needed())
    filter = [sight](Index body, const Vec3& a, const Vec3& b) { return (*sight)(body, a, b); };
  prepare_state(state, neighborhood_settings(scene.solver), filter, filter, gradient);
  give_paper_masses(scene, state, world.warnings);
  check_support(scene, state);
  if (state.fit.linear_fits > 0)
    world.warnings.push_back(
        fmt::format("{} of {} particles have too few neighbours for the quadratic fit: the linear "
                    "one stands in",
                    state.fit.linear_fits, state.size()));
  const bool irregular = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const SceneBody& body) {
    return body.jitter > 0.0 || body.sampling == "blue_noise";
  });
  if (irregular && state.fit.consistency.left_out > 0)
    world.warnings.push_back(fmt::format(
        "{} irregular particles are too many for the correction that makes a uniform stress exact "
        "inside; about 1 % of it is left as noise",
        state.fit.consistency.left_out));
  if (state.fit.consistency.remainder > 1e-6)
    world.warnings.push_back(
        fmt::format("the correction that makes a uniform stress exact inside has not converged: {:.1g} of "
                    "the error is left",
                    state.fit.consistency.remainder));
  if (std::size_t thin = state.fit.count_below(3); thin > 0)
    world.warnings.push_back(
        fmt::format("{} of {} particles have neighbours on one line or plane only, or none: they resist less",
                    thin, state.size()));
  warn_of_missing_contact(scene, state, world.warnings);
  check_overlaps(state, meshes, contacts_of(scene), world.warnings);

  world.bodies = facts_of(state);
  std::vector<std::unique_ptr<Effect>> effects = make_effects(scene, state);
  try {
    world.solver =
        std::make_unique<Solver>(std::move(state), std::move(effects), solver_settings(scene.solver));
  } catch (const std::invalid_argument& error) {
    throw UserError(fmt::format("{}: {}", scene.file.string(), error.what()));
  }
  return world;
}

}  // namespace deforma
