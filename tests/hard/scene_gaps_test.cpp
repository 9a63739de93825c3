#include <Eigen/Geometry>
#include <set>

#include "assets/shapes.hpp"
#include "tests/assets/fixtures.hpp"
#include "tests/hard/refusal.hpp"
#include "tests/pipeline/mesh_text.hpp"
#include "tests/sim/gradient_check.hpp"

namespace deforma {
namespace {

const std::string material =
    "particles = 1200\ndensity = 1000\nelastic = { young = 1e6, poisson = 0.3 }\nvolume = { stiffness = 1e6 "
    "}\n"
    "damping = { viscosity = 10 }\n";

/// The state of a scene's world and its strain-driven effects, to be moved by hand.
struct Puppet {
  State state;
  std::vector<std::unique_ptr<Effect>> effects;

  explicit Puppet(const World& world) : state(world.solver->state()) {
    effects = make_effects(
        state, std::vector<EffectRequest>{{"elastic", {0, given("elastic", {{"young", 1e6}})}},
                                          {"hourglass", {0, given("hourglass")}},
                                          {"volume", {0, given("volume", {{"stiffness", 1e6}})}}});
  }
  std::vector<Vec3> force() { return total_force(state, effects); }
};

/// Pairs within each other's support in different parts: those that a search by distance alone would link.
template <typename PartOf>
std::size_t near_across(const State& state, const PartOf& part_of) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < state.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (part_of(state.particles.rest[i]) != part_of(state.particles.rest[j]) &&
          (state.particles.rest[i] - state.particles.rest[j]).norm() <
              0.5 * (state.links.support[i] + state.links.support[j]))
        ++count;
  return count;
}

template <typename PartOf>
std::size_t links_across(const State& state, const PartOf& part_of) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < state.size(); ++i)
    for (Index k = state.links.row(i).begin; k < state.links.row(i).end; ++k)
      if (part_of(state.particles.rest[i]) != part_of(state.particles.rest[state.links.links[k].j])) ++count;
  for (std::size_t s = 0; s < state.surface.size(); ++s)
    for (const Skin::Tie& tie : state.surface.skin.row(s))
      if (part_of(state.surface.rest[s]) != part_of(state.particles.rest[tie.particle])) ++count;
  return count;
}

TEST(HardCase, Row31LinksNeverJoinComponents) {
  Scratch scratch;
  // Three balls in a triangle, the gaps between them a hundredth of their radius.
  const double far = 1.01;
  const std::vector<Vec3> centers = {{0, 0, 0}, {far, 0, 0}, {0.5 * far, std::sqrt(0.75) * far, 0}};
  Mesh three;
  for (const Vec3& center : centers) three = merged(three, moved(make_sphere(0.5, 8), center));
  scratch.write("three.obj", obj_text(three));
  auto ball_of = [&](const Vec3& p) {
    std::size_t nearest = 0;
    for (std::size_t c = 1; c < 3; ++c)
      if ((p - centers[c]).norm() < (p - centers[nearest]).norm()) nearest = c;
    return nearest;
  };
  for (const std::string& solver : both_gradients)
    for (std::string sampling : {"lattice", "body_centered", "blue_noise"}) {
      SCOPED_TRACE(solver + sampling);
      World world =
          build_text(scratch, mesh_scene("three.obj", material + "sampling = \"" + sampling + "\"", solver));
      Puppet puppet(world);
      State& state = puppet.state;
      ASSERT_GT(near_across(state, ball_of), 20u) << "the gaps must be narrower than the support";
      EXPECT_EQ(links_across(state, ball_of), 0u);
      for (std::size_t moving = 0; moving < 3; ++moving) {
        std::fill(state.particles.displacement.begin(), state.particles.displacement.end(), Vec3::Zero());
        for (std::size_t i = 0; i < state.size(); ++i)
          if (ball_of(state.particles.rest[i]) == moving)
            state.particles.displacement[i] = 1e-3 * state.bodies[0].spacing * Vec3(1, -2, 2).normalized();
        // Every other one of the moved ball stays, so that it is strained as well.
        for (std::size_t i = 0; i < state.size(); i += 2) state.particles.displacement[i].setZero();
        const std::vector<Vec3> force = puppet.force();
        double felt = 0.0;
        for (std::size_t i = 0; i < state.size(); ++i) {
          const std::size_t ball = ball_of(state.particles.rest[i]);
          if (ball == moving) felt = std::max(felt, force[i].norm());
          EXPECT_TRUE(ball == moving || force[i] == Vec3(0, 0, 0))
              << "ball " << ball << ": " << force[i].transpose();
        }
        EXPECT_GT(felt, 0.0);
      }
    }
}

TEST(HardCase, Row31AMovingComponentMovesNoOther) {
  Scratch scratch;
  Mesh three;
  for (double x : {0.0, 1.01, 2.02}) three = merged(three, moved(make_sphere(0.5, 8), {x, 0, 0}));
  scratch.write("three.obj", obj_text(three));
  for (const std::string& solver : both_gradients) {
    // A load on the middle one alone, through the whole program's own effects.
    World world = build_text(
        scratch, mesh_scene("three.obj",
                            material + "load = { force = [0, 0, 50], region = { min = [0.505, -1, -1], max = "
                                       "[1.515, 1, 1] } }\n",
                            solver));
    world.solver->advance(0.05);
    const State& state = world.solver->state();
    double moved_most = 0.0;
    for (std::size_t i = 0; i < state.size(); ++i) {
      double x = state.particles.rest[i].x();
      const Vec3& u = state.particles.displacement[i];
      const bool loaded = x > 0.505 && x < 1.515;
      if (loaded) moved_most = std::max(moved_most, u.norm());
      EXPECT_TRUE(loaded || u == Vec3(0, 0, 0)) << x;
    }
    EXPECT_GT(moved_most, 1e-3 * state.bodies[0].spacing);
  }
}

TEST(HardCase, Row32LegsCloserThanTheSupport) {
  Scratch scratch;
  for (double slit : {0.1, 0.01, 0.001}) {
    scratch.write("legs.obj", obj_text(make_legs(slit)));
    // 0: the bar; 1, 2: what of the legs is above it.
    auto part_of = [&](const Vec3& p) { return p.z() <= 1.0 ? 0 : p.x() < 1.0 + 0.5 * slit ? 1 : 2; };
    for (const std::string& solver : both_gradients)
      for (std::string sampling : {"lattice", "body_centered", "blue_noise"}) {
        SCOPED_TRACE(solver + sampling + " " + std::to_string(slit));
        World world =
            build_text(scratch, mesh_scene("legs.obj", material + "sampling = \"" + sampling + "\"", solver));
        Puppet puppet(world);
        State& state = puppet.state;
        std::size_t near = 0, across = 0;
        for (std::size_t i = 0; i < state.size(); ++i) {
          const int part = part_of(state.particles.rest[i]);
          for (std::size_t j = 0; j < i; ++j)
            if (part * part_of(state.particles.rest[j]) == 2 &&
                (state.particles.rest[i] - state.particles.rest[j]).norm() <
                    0.5 * (state.links.support[i] + state.links.support[j]))
              ++near;
          for (Index k = state.links.row(i).begin; k < state.links.row(i).end; ++k)
            if (part * part_of(state.particles.rest[state.links.links[k].j]) == 2) ++across;
        }
        ASSERT_GT(near, 50u) << "the slit must be narrower than the support";
        EXPECT_EQ(across, 0u);

        // Far enough above the bar that no chain of two supports leads around through it.
        const double above =
            1.0 + 2.0 * *std::max_element(state.links.support.begin(), state.links.support.end());
        ASSERT_LT(above, 2.9);
        for (std::size_t i = 0; i < state.size(); ++i)
          if (part_of(state.particles.rest[i]) == 1 && state.particles.rest[i].z() > above && i % 2 == 0)
            state.particles.displacement[i] = 1e-3 * state.bodies[0].spacing * Vec3(1, -2, 2).normalized();
        const std::vector<Vec3> force = puppet.force();
        double felt = 0.0;
        for (std::size_t i = 0; i < state.size(); ++i) {
          const bool other = part_of(state.particles.rest[i]) == 2;
          EXPECT_TRUE(!other || force[i] == Vec3(0, 0, 0)) << state.particles.rest[i].transpose();
          if (!other) felt = std::max(felt, force[i].norm());
        }
        EXPECT_GT(felt, 0.0);
      }
  }
}

}  // namespace
}  // namespace deforma
