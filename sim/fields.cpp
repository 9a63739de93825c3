#include "sim/fields.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "sim/parallel.hpp"

namespace deforma {

namespace {

constexpr std::size_t blocks_at_a_time = 4;  // for one thread
constexpr double anything = -std::numeric_limits<double>::infinity();

constexpr std::array<FieldInfo, 6> registry = {{
    {FieldKind::displacement, "displacement", "displacement", "m", 0.0, 0.0},
    {FieldKind::speed, "speed", "speed", "m/s", 0.0, 0.0},
    {FieldKind::von_mises, "von_mises", "von Mises stress", "Pa", 0.0, 0.0},
    {FieldKind::principal_stretch, "principal_stretch", "largest principal stretch", "1", 1.0, 0.0},
    {FieldKind::det_f, "det_f", "volume ratio det F", "1", 1.0, anything},
    {FieldKind::energy_density, "energy_density", "strain energy density", "J/m³", 0.0, 0.0},
}};

/// F^T F, with the directions that the neighbours do not span left unstretched.
Mat3 right_cauchy_green(const Mat3& F, const Mat3& projector) {
  return F.transpose() * F + (Mat3::Identity() - projector);
}

/// Ratio of volumes; of a sheet or a rope that of its area or length.
double volume_ratio(const Mat3& F, const Mat3& projector, int rank) {
  return rank == 3 ? F.determinant() : std::sqrt(right_cauchy_green(F, projector).determinant());
}

double largest_stretch(const Mat3& F, const Mat3& projector) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(right_cauchy_green(F, projector), Eigen::EigenvaluesOnly);
  return std::sqrt(solver.eigenvalues().z());
}

double von_mises(const Mat3& P, const Mat3& F, double J) {
  const Mat3 cauchy = P * F.transpose() / J;
  const Mat3 deviator = cauchy - cauchy.trace() / 3.0 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

/// Those effects that answer strain. Each is asked about no particle first, so that what takes no part says so before
/// several threads ask.
std::vector<Effect*> stressing(const State& state, std::span<const std::unique_ptr<Effect>> effects) {
  std::vector<Effect*> found;
  for (const auto& effect : effects) {
    effect->stress(state, {0, {0, 0}}, {}, {}, {});
    if (effect->takes_part(Effect::at_stress)) found.push_back(effect.get());
  }
  return found;
}

/// The values of one block.
void evaluate_block(FieldKind kind, const State& state, std::span<Effect* const> effects, const Block& block,
                    std::span<double> values) {
  std::array<Mat3, Block::most> F, P;
  std::array<double, Block::most> pair_stiffness;
  const std::size_t count = block.size();
  const std::span<Mat3> strain = std::span(F).first(count), stress = std::span(P).first(count);
  block_deformation_gradients(state.links, state.fit, state.particles.displacement, block.particles, strain);
  if (kind == FieldKind::von_mises) {
    std::fill(stress.begin(), stress.end(), Mat3::Zero());
    for (Effect* effect : effects)
      effect->stress(state, block, strain, stress, std::span(pair_stiffness).first(count));
  }
  std::fill(values.begin(), values.end(), 0.0);
  if (kind == FieldKind::energy_density)
    for (const Effect* effect : effects) effect->energy_density(state, block, strain, values);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = block.particles.begin + k;
    const Mat3& Q = state.fit.projector(i);
    if (kind == FieldKind::von_mises)
      values[k] = von_mises(P[k], F[k], volume_ratio(F[k], Q, state.fit.rank[i]));
    if (kind == FieldKind::principal_stretch) values[k] = largest_stretch(F[k], Q);
    if (kind == FieldKind::det_f) values[k] = volume_ratio(F[k], Q, state.fit.rank[i]);
  }
}

void evaluate_strain(FieldKind kind, const State& state, std::span<const std::unique_ptr<Effect>> effects,
                     std::span<float> at_particles, std::span<float> at_vertices) {
  const std::vector<Block> blocks = make_blocks(state.bodies);
  const std::vector<Effect*> answering = stressing(state, effects);
  std::vector<double> values(state.size());
  parallel_for_each(
      blocks.size(),
      [&](std::size_t b) { evaluate_block(kind, state, answering, blocks[b], part(values, blocks[b])); },
      blocks_at_a_time);
  if (!at_particles.empty())
    std::transform(values.begin(), values.end(), at_particles.begin(),
                   [](double value) { return static_cast<float>(value); });
  parallel_for_each(at_vertices.size(), [&](std::size_t s) {
    double sum = 0.0;
    for (const Skin::Tie& tie : state.surface.skin.row(s)) sum += tie.weight * values[tie.particle];
    at_vertices[s] = static_cast<float>(sum);
  });
}

/// Lengths of the vectors of `field`, at the vertices as they move with it.
void evaluate_length(std::span<const Vec3> field, const State& state, std::span<float> at_particles,
                     std::span<float> at_vertices) {
  for (std::size_t i = 0; i < at_particles.size(); ++i) at_particles[i] = static_cast<float>(field[i].norm());
  if (at_vertices.empty()) return;
  std::vector<Mat3> gradients(state.size());
  deformation_gradients(state.links, state.fit, field, gradients);
  parallel_for_each(at_vertices.size(), [&](std::size_t s) {
    at_vertices[s] = static_cast<float>(
        skinned_point(state.surface.skin, s, Vec3::Zero(), field, gradients, state.fit).norm());
  });
}

}  // namespace

std::span<const FieldInfo> field_registry() { return registry; }

std::span<const std::string_view> field_names() {
  static const auto names = [] {
    std::array<std::string_view, registry.size()> all;
    std::transform(registry.begin(), registry.end(), all.begin(), [](const FieldInfo& f) { return f.name; });
    return all;
  }();
  return names;
}

const FieldInfo& find_field(std::string_view name) {
  for (const FieldInfo& field : registry)
    if (field.name == name) return field;
  throw std::invalid_argument(
      fmt::format("unknown field '{}' (allowed: {})", name, fmt::join(field_names(), ", ")));
}

void evaluate_field(const FieldInfo& field, const State& state,
                    std::span<const std::unique_ptr<Effect>> effects, std::span<float> at_particles,
                    std::span<float> at_vertices) {
  if ((!at_particles.empty() && at_particles.size() != state.size()) ||
      (!at_vertices.empty() && at_vertices.size() != state.surface.size()))
    throw std::invalid_argument(fmt::format("{} particles and {} vertices, but room for {} and {} values",
                                            state.size(), state.surface.size(), at_particles.size(),
                                            at_vertices.size()));
  switch (field.kind) {
    case FieldKind::displacement:
      return evaluate_length(state.particles.displacement, state, at_particles, at_vertices);
    case FieldKind::speed:
      return evaluate_length(state.particles.velocity, state, at_particles, at_vertices);
    default:
      return evaluate_strain(field.kind, state, effects, at_particles, at_vertices);
  }
}

}  // namespace deforma
