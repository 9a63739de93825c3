#include "tests/hard/bodies.hpp"

namespace deforma {
namespace {

using namespace hard;

TEST(HardCase, Row33SurfaceVertexOnAParticleAndFarFromAll) {
  std::mt19937 generator(9);
  for (Gradient gradient : both_fits) {
    State state = cube_particles(0.2);
    prepare(state, gradient);
    const double far = 100 * *std::max_element(state.links.support.begin(), state.links.support.end());
    state.surface.rest[0] = state.particles.rest[100];
    state.surface.rest[1] = state.surface.rest[1] + far * Vec3(-1, -1, -1).normalized();
    prepare(state, gradient);
    EXPECT_TRUE(finite_everywhere(state));
    const auto row = state.surface.skin.row(1);
    ASSERT_EQ(row.size(), 1u) << "the nearest particle alone";
    EXPECT_EQ(row[0].weight, 1.0);
    for (const Vec3& X : state.particles.rest)
      EXPECT_GE((X - state.surface.rest[1]).norm(), row[0].arm.norm());

    for (int k = 0; k < 10; ++k) {
      const Mat3 turn = random_rotation(generator);
      const Vec3 shift = far * random_direction(generator);
      move_rigidly(state, turn, shift);
      deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
      std::vector<Vec3> points(state.surface.size());
      deform_surface(state.surface, state.particles, state.fit, state.F, points);
      for (std::size_t s = 0; s < points.size(); ++s)
        ASSERT_LT((points[s] - (turn * state.surface.rest[s] + shift)).norm(), 1e-12 * far) << "vertex " << s;
    }
  }
}

}  // namespace
}  // namespace deforma
