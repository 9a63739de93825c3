#include "pipeline/bench_body.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/neighborhood.hpp"

namespace deforma {

namespace {

constexpr double jitter = 0.2;  // spacings
constexpr int neighbors = 18;   // that the mean distance is taken of

/// Mean number of links of such a body, as far as links depend on the support.
double mean_links(const BenchBody& body, double support) {
  // Beyond so many across the surface hardly counts.
  constexpr int enough = 32;
  Particles particles;
  std::mt19937 generator(1);
  auto place = [&](int k) { return bench_spacing * (k + jitter * (generator() / 2147483648.0 - 1.0)); };
  const auto [nx, ny, nz] = body.across;
  for (int x = 0; x < std::min(nx, enough); ++x)
    for (int y = 0; y < std::min(ny, enough); ++y)
      for (int z = 0; z < std::min(nz, enough); ++z) particles.rest.push_back({place(x), place(y), place(z)});
  const auto count = static_cast<Index>(particles.size());
  Body all;
  all.particles = {0, count};
  all.spacing = bench_spacing;
  const Neighborhood links =
      build_neighborhood(particles, std::span(&all, 1), {.neighbors = neighbors, .support = support});
  return static_cast<double>(links.links.size()) / static_cast<double>(count);
}

/// Links fill a ball, so their number grows as the third power of the support; near the surface more slowly.
double support_for(const BenchBody& body, double links) {
  double support = 1.7;
  for (int round = 0; round < 2; ++round) support *= std::cbrt(links / mean_links(body, support));
  return support;
}

SceneShape box(const BenchBody& body) {
  const auto boxes = std::find_if(shape_registry().begin(), shape_registry().end(),
                                  [](const ShapeInfo& shape) { return shape.name == "box"; });
  SceneShape shape{&*boxes, Parameters(boxes->settings)};
  const auto [nx, ny, nz] = body.across;
  shape.parameters.set("size", Curve<Vec3>(bench_spacing * Vec3(nx, ny, nz)));
  shape.parameters.set("resolution", Curve<double>(std::max({nx, ny, nz})));
  return shape;
}

}  // namespace

BenchBody bench_box(int particles) {
  const int across = std::max(2, static_cast<int>(std::lround(std::cbrt(particles))));
  BenchBody body;
  body.across = {across, across, across};
  for (int x = across; x > across / 2; --x) {
    if (particles % x != 0) continue;
    const int face = particles / x;
    int y = static_cast<int>(std::sqrt(face));
    while (face % y != 0) --y;
    if (std::max(x, face / y) > 2 * std::min(x, y)) continue;
    body.across = {x, y, face / y};
    break;
  }
  return body;
}

Scene bench_scene(const BenchBody& body) {
  Scene scene;
  scene.file = scene.name = "bench";
  scene.duration = 1.0;
  scene.output.video = "none";
  scene.solver.gradient = gradient_name(body.gradient);
  if (body.links) {
    scene.solver.neighbors = neighbors;
    scene.solver.support = support_for(body, *body.links);
  }
  SceneBody& one = scene.bodies.emplace_back();
  one.name = one.where = one.mesh_where = "bench body";
  one.shape = box(body);
  one.position = 0.5 * bench_spacing * Vec3(body.across[0], body.across[1], body.across[2]);
  one.particles = body.particles();
  one.jitter = jitter;
  one.angular_velocity = Vec3(0.3, 0.2, 0.1);
  add_effect(one, "elastic",
             {{"young", Curve<double>(bench_young)}, {"poisson", Curve<double>(bench_poisson)}});
  if (body.hourglass) add_effect(one, "hourglass");
  return scene;
}

Scene bench_pair(const BenchBody& body, double gap) {
  Scene scene = bench_scene(body);
  scene.bodies[0].angular_velocity.setZero();
  scene.bodies.push_back(scene.bodies[0]);
  SceneBody& lower = scene.bodies.front();
  SceneBody& upper = scene.bodies.back();
  upper.name = "upper bench body";
  upper.position.z() += (body.across[2] + gap) * bench_spacing;
  Region bottom, top;
  bottom.max.z() = 0.01 * bench_spacing;
  top.min.z() = (2 * body.across[2] + gap - 0.01) * bench_spacing;
  add_effect(lower, "pin", {{"region", bottom}});
  add_effect(upper, "pin", {{"region", top}});
  return scene;
}

void add_effect(SceneBody& body, std::string_view name,
                const std::vector<std::pair<std::string_view, SettingValue>>& values) {
  const EffectInfo& info = find_effect(name);
  Parameters parameters(info.settings);
  for (const auto& [key, value] : values) parameters.set(key, value);
  parameters.require_complete();
  body.effects.push_back({&info, std::move(parameters), std::string("bench: ").append(name)});
}

}  // namespace deforma
