#include "sim/consistency.hpp"

#include <gtest/gtest.h>

#include "fixtures.hpp"

namespace deforma {
namespace {

State box(double jitter, int n = 9) {
  return lattice_box(Vec3::Constant(0.1 * n), n, n, n, 1000.0, jitter, {.neighbors = 30, .support = 1.7},
                     Gradient::quadratic);
}

// sum_i w_i G_ik: the force that a uniform unit stress leaves on k.
std::vector<Vec3> left_by_uniform_stress(const State& state) {
  std::vector<Vec3> sum(state.size(), Vec3::Zero());
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Range row = state.links.row(i);
    for (Index l = row.begin; l < row.end; ++l) {
      sum[state.links.links[l].j] += state.fit.weight[i] * gradient_vector(state.fit.there[l]);
      sum[i] -= state.fit.weight[i] * gradient_vector(state.fit.there[l]);
    }
  }
  return sum;
}

TEST(Consistency, UniformStressLeavesNoForceInside) {
  for (double jitter : {0.0, 0.2}) {
    State state = box(jitter);
    const CompleteNeighborhoods complete =
        complete_neighborhoods(state.particles, state.bodies, state.links, state.surface);
    ASSERT_GE(complete.particles.size(), 27u);
    EXPECT_EQ(state.fit.consistency.corrected, complete.particles.size());
    const std::vector<Vec3> left = left_by_uniform_stress(state);
    double outside = 0.0;
    for (const Vec3& force : left) outside = std::max(outside, force.norm());
    EXPECT_GT(outside, 0.1 * 0.01);  // where the surface is, a stress must be held by a traction
    for (Index k : complete.particles) EXPECT_LT(left[k].norm(), 1e-13);
  }
}

TEST(Consistency, WithoutItJitteredParticlesWouldFeelUniformStress) {
  State state = box(0.2);
  const CompleteNeighborhoods complete =
      complete_neighborhoods(state.particles, state.bodies, state.links, state.surface);
  state.fit = fit_moving_least_squares(state.particles, state.links, Gradient::quadratic);
  const std::vector<Vec3> left = left_by_uniform_stress(state);
  double inside = 0.0;
  for (Index k : complete.particles) inside = std::max(inside, left[k].norm());
  EXPECT_GT(inside, 1e-4);
}

TEST(Consistency, KeepsQuadraticFieldsAndBothWaysOfEveryLink) {
  State state = box(0.2);
  ASSERT_GT(state.fit.consistency.corrected, 0u);
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3& X = state.particles.rest[i];
    state.particles.displacement[i] =
        Vec3(X.x() * X.x() - X.y(), X.y() * X.z(), X.z() * X.x() + 2.0 * X.y() * X.y());
  }
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3& X = state.particles.rest[i];
    const Mat3 exact =
        (Mat3() << 1 + 2 * X.x(), -1, 0, 0, 1 + X.z(), X.y(), X.z(), 4 * X.y(), 1 + X.x()).finished();
    EXPECT_LT((state.F[i] - exact).norm(), 1e-11);
  }
  const std::vector<Index> reverse = reverse_links(state.links);
  for (std::size_t l = 0; l < reverse.size(); ++l) {
    EXPECT_EQ(reverse[reverse[l]], l);
    EXPECT_EQ(gradient_vector(state.fit.back[l]), gradient_vector(state.fit.there[reverse[l]]));
  }
}

TEST(Consistency, OfABodyIsTheSameWhateverElseThereIs) {
  const State alone = box(0.2);
  State both = lattice_particles(Vec3::Constant(0.9), 9, 9, 9, 1000.0, 0.2);
  append_body(both, lattice_particles(Vec3::Constant(9e-4), 9, 9, 9, 1000.0, 0.2), Vec3(5, 0, 0));
  prepare_state(both, {.neighbors = 30, .support = 1.7}, {}, {}, Gradient::quadratic);
  ASSERT_GT(alone.fit.consistency.corrected, 0u);
  EXPECT_EQ(both.fit.consistency.corrected, 2 * alone.fit.consistency.corrected);
  for (std::size_t l = 0; l < alone.fit.there.size(); ++l)
    EXPECT_EQ(gradient_vector(both.fit.there[l]), gradient_vector(alone.fit.there[l]));
  const CompleteNeighborhoods complete =
      complete_neighborhoods(both.particles, both.bodies, both.links, both.surface);
  const std::vector<Vec3> left = left_by_uniform_stress(both);
  for (Index k : complete.particles)
    if (both.particles.body[k] == 1) {
      EXPECT_LT(left[k].norm(), 1e-6 * 1e-13);
    }
}

TEST(Consistency, LeavesOutBodiesWithTooManyInside) {
  State state = box(0.2, 18);
  EXPECT_EQ(state.fit.consistency.corrected, 0u);
  EXPECT_GT(state.fit.consistency.left_out, 2000u);
}

}  // namespace
}  // namespace deforma
