#include "sim/merge.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "sim/parallel.hpp"
#include "sim/point_tree.hpp"

namespace deforma {

namespace {

/// For every particle of a body the one that stands for it: itself, or an earlier one that stands for itself.
std::vector<Index> find_stand_ins(const Particles& particles, const Body& body) {
  std::span<const Vec3> rest(particles.rest);
  PointTree tree(rest.subspan(body.particles.begin, body.particles.size()));
  std::vector<Index> stands_for(body.particles.size());
  std::iota(stands_for.begin(), stands_for.end(), Index{0});
  // The search excludes its radius, and coincidence is no distance at all when a body has no spacing.
  const double reach =
      std::max(coincident_share * body.spacing, std::sqrt(std::numeric_limits<double>::min()));
  std::vector<char> accompanied(body.particles.size());
  parallel_for_each(body.particles.size(), [&](std::size_t i) {
    std::vector<PointTree::Found> found;
    tree.within(rest[body.particles.begin + i], reach, found);
    accompanied[i] = found.size() > 1;
  });
  std::vector<PointTree::Found> found;
  for (Index i = 0; i < stands_for.size(); ++i) {
    if (!accompanied[i] || stands_for[i] != i) continue;
    tree.within(rest[body.particles.begin + i], reach, found);
    for (const auto& [j, distance] : found)
      if (j > i && stands_for[j] == j) stands_for[j] = i;
  }
  return stands_for;
}

void add(Particles& particles, Index into, Index from) {
  double mass = particles.mass[into] + particles.mass[from];
  double share = mass > 0.0 ? particles.mass[from] / mass : 0.0;
  auto mix = [&](std::vector<Vec3>& field) { field[into] += share * (field[from] - field[into]); };
  mix(particles.displacement);
  mix(particles.velocity);
  particles.mass[into] = mass;
  particles.volume[into] += particles.volume[from];
  if (!particles.cells.empty()) {
    particles.cells[into].first += particles.cells[from].first;
    particles.cells[into].second += particles.cells[from].second;
  }
}

void move(Particles& particles, Index to, Index from) {
  particles.rest[to] = particles.rest[from];
  particles.displacement[to] = particles.displacement[from];
  particles.velocity[to] = particles.velocity[from];
  particles.mass[to] = particles.mass[from];
  particles.volume[to] = particles.volume[from];
  if (!particles.cells.empty()) particles.cells[to] = particles.cells[from];
  particles.body[to] = particles.body[from];
}

void resize(Particles& particles, std::size_t n) {
  particles.rest.resize(n);
  particles.displacement.resize(n);
  particles.velocity.resize(n);
  particles.mass.resize(n);
  particles.volume.resize(n);
  if (!particles.cells.empty()) particles.cells.resize(n);
  particles.body.resize(n);
}

}  // namespace

std::vector<std::size_t> merge_coincident(Particles& particles, std::vector<Body>& bodies) {
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (!particles.rest[i].allFinite())
      throw std::invalid_argument(fmt::format("particle {} has a rest position that is not finite", i));
  std::vector<std::size_t> lost;
  Index kept = 0;
  for (Body& body : bodies) {
    const Range before = body.particles;
    std::vector<Index> stands_for = find_stand_ins(particles, body);
    const Index first = kept;
    for (Index i = 0; i < stands_for.size(); ++i)
      if (stands_for[i] != i) add(particles, before.begin + stands_for[i], before.begin + i);
    for (Index i = 0; i < stands_for.size(); ++i)
      if (stands_for[i] == i) move(particles, kept++, before.begin + i);
    body.particles = {first, kept};
    lost.push_back(before.size() - body.particles.size());
    if (lost.back() > 0)
      body.spacing *=
          std::cbrt(static_cast<double>(before.size()) / static_cast<double>(body.particles.size()));
  }
  resize(particles, kept);
  return lost;
}

}  // namespace deforma
