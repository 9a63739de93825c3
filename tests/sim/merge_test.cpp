#include "sim/merge.hpp"

#include <gmock/gmock.h>

#include "tests/sim/fixtures.hpp"

namespace deforma {
namespace {

TEST(Merge, LeavesSeparateParticlesAsTheyAre) {
  for (double size : {1e-9, 1.0, 1e9}) {
    State state = lattice_particles(Vec3::Constant(size), 4, 3, 2, 1000.0, 0.3);
    const Particles before = state.particles;
    const double spacing = state.bodies[0].spacing;
    EXPECT_EQ(merge_coincident(state.particles, state.bodies), std::vector<std::size_t>{0});
    EXPECT_EQ(state.particles.rest, before.rest);
    EXPECT_EQ(state.particles.mass, before.mass);
    EXPECT_EQ(state.bodies[0].spacing, spacing);
  }
}

TEST(Merge, TakesPlacesTogetherAtAnyScale) {
  for (double size : {1e-9, 1.0, 1e9}) {
    State state = lattice_particles(Vec3::Constant(size), 4, 3, 2, 1000.0, 0.3);
    Particles& p = state.particles;
    p.rest[5] = p.rest[20] + 0.9e-6 * state.bodies[0].spacing * Vec3::UnitY();
    p.rest[7] = p.rest[20] + 1.2e-6 * state.bodies[0].spacing * Vec3::UnitZ();  // too far from both
    p.displacement[20] = Vec3(3e-3 * size, 0, 0);
    p.velocity[5] = Vec3(4, 0, 0);
    p.mass[5] *= 3.0;
    const double mass = p.mass[5] + p.mass[20];
    EXPECT_EQ(merge_coincident(p, state.bodies), std::vector<std::size_t>{1});
    ASSERT_EQ(state.size(), 23u);
    EXPECT_DOUBLE_EQ(p.mass[5], mass);
    EXPECT_DOUBLE_EQ(p.velocity[5].x(), 3.0);
    EXPECT_DOUBLE_EQ(p.displacement[5].x(), 0.75e-3 * size);
    EXPECT_DOUBLE_EQ(p.volume[5], 2.0 * p.volume[0]);
  }
}

TEST(Merge, WithoutASpacingOnlyTheSamePlaceCounts) {
  State state = lattice_particles(Vec3::Constant(1.0), 2, 2, 2, 1000.0);
  state.bodies[0].spacing = 0.0;
  state.particles.rest[1] = state.particles.rest[0];
  state.particles.rest[3] = state.particles.rest[2] + Vec3(1e-15, 0, 0);
  EXPECT_EQ(merge_coincident(state.particles, state.bodies), std::vector<std::size_t>{1});
}

TEST(Merge, RefusesPositionsThatAreNotFinite) {
  State state = lattice_particles(Vec3::Constant(1.0), 2, 2, 2, 1000.0);
  state.particles.rest[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { merge_coincident(state.particles, state.bodies); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::HasSubstr("particle 3 has a rest position that is not finite")));
}

}  // namespace
}  // namespace deforma
