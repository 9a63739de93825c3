#include <numeric>

#include "sim/merge.hpp"
#include "tests/hard/refusal.hpp"
#include "tests/sim/fixtures.hpp"
#include "tests/sim/gradient_check.hpp"

namespace deforma {
namespace {

using testing::HasSubstr;

/// The reference cube before it is prepared, every particle `times` over, the copies `apart` [m] from the first.
State repeated_cube(int times, double apart) {
  State state = lattice_particles(Vec3::Constant(0.6), 6, 6, 6, 1000.0);
  Particles& p = state.particles;
  const std::size_t n = p.size();
  for (double& mass : p.mass) mass /= times;
  for (double& volume : p.volume) volume /= times;
  for (Cell& cell : p.cells) cell = {cell.first / times, cell.second / times};
  for (int copy = 1; copy < times; ++copy)
    for (std::size_t i = 0; i < n; ++i) {
      p.rest.push_back(p.rest[i] + apart * Vec3(1, -1, 1).normalized());
      p.displacement.push_back(Vec3::Zero());
      p.velocity.push_back(Vec3::Zero());
      p.mass.push_back(p.mass[i]);
      p.volume.push_back(p.volume[i]);
      p.cells.push_back(p.cells[i]);
      p.body.push_back(0);
    }
  state.bodies[0].particles.end = static_cast<Index>(p.size());
  state.bodies[0].spacing = std::cbrt(0.216 / static_cast<double>(p.size()));
  return state;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::vector<std::unique_ptr<Effect>> elastic_effects(State& state) {
  return make_effects(state, std::vector<EffectRequest>{{"elastic", {0, given("elastic", {{"young", 1e6}})}},
                                                        {"hourglass", {0, given("hourglass")}}});
}

TEST(HardCase, Row06EveryParticleTwice) {
  for (Gradient gradient : {Gradient::linear, Gradient::quadratic})
    for (int times : {2, 3})
      for (double apart : {0.0, 1e-9, 1e-8}) {
        State state = repeated_cube(times, apart);
        const double mass = sum(state.particles.mass), volume = sum(state.particles.volume);
        std::vector<std::size_t> lost = merge_coincident(state.particles, state.bodies);
        EXPECT_EQ(lost, std::vector<std::size_t>{216u * static_cast<std::size_t>(times - 1)}) << apart;
        EXPECT_EQ(state.size(), 216u);
        EXPECT_EQ(state.bodies[0].particles.size(), 216u);
        EXPECT_NEAR(state.bodies[0].spacing, 0.1, 1e-12);
        EXPECT_NEAR(sum(state.particles.mass), mass, 1e-12 * mass);
        EXPECT_NEAR(sum(state.particles.volume), volume, 1e-12 * volume);

        NeighborhoodSettings settings;
        if (gradient == Gradient::quadratic) settings.neighbors = 30, settings.support = 1.7;
        prepare_state(state, settings, {}, {}, gradient);
        EXPECT_EQ(state.fit.count_below(3), 0u);
        // The same body as the cube without doubles, to the last bit: the first of each place stays.
        State plain = lattice_particles(Vec3::Constant(0.6), 6, 6, 6, 1000.0);
        EXPECT_EQ(state.particles.rest, plain.particles.rest);
        state.particles.velocity[0] = Vec3(1, 2, 3);
        auto effects = elastic_effects(state);
        Solver solver(std::move(state), std::move(effects), {});
        solver.advance(0.2);
        EXPECT_TRUE(all_finite(solver.state()));
      }
}

TEST(HardCase, Row06ParticlesApartStayTwo) {
  // Farther than a millionth of the spacing: nothing is merged, and it is not unstable either.
  State state = repeated_cube(2, 1e-6);
  EXPECT_EQ(merge_coincident(state.particles, state.bodies), std::vector<std::size_t>{0});
  EXPECT_EQ(state.size(), 432u);
}

TEST(HardCase, Row06MergingKeepsMomentumAndOtherBodies) {
  State state = repeated_cube(2, 0.0);
  State other = lattice_particles(Vec3::Constant(0.2), 2, 2, 2, 500.0);
  append_body(state, repeated_cube(2, 0.0), Vec3::Zero());  // in the same place: bodies are never merged
  append_body(state, other, Vec3(3, 0, 0));
  std::mt19937 generator(3);
  for (std::size_t i = 0; i < state.size(); ++i) {
    state.particles.mass[i] *= 1.0 + generator() / 4294967296.0;
    for (int axis = 0; axis < 3; ++axis) state.particles.velocity[i][axis] = generator() / 2147483648.0 - 1.0;
  }
  auto momentum = [&] {
    Vec3 p = Vec3::Zero();
    for (std::size_t i = 0; i < state.size(); ++i) p += state.particles.mass[i] * state.particles.velocity[i];
    return p;
  };
  const Vec3 before = momentum();
  const double mass = sum(state.particles.mass);
  EXPECT_EQ(merge_coincident(state.particles, state.bodies), (std::vector<std::size_t>{216, 216, 0}));
  EXPECT_LT((momentum() - before).norm(), 1e-12 * mass);
  EXPECT_NEAR(sum(state.particles.mass), mass, 1e-12 * mass);
  EXPECT_EQ(state.bodies[1].particles.begin, 216u);
  EXPECT_EQ(state.bodies[2].particles.begin, 432u);
  EXPECT_EQ(state.size(), 440u);
  for (std::size_t i = 0; i < state.size(); ++i)
    EXPECT_TRUE(state.bodies[state.particles.body[i]].particles.contains(static_cast<Index>(i)));
  EXPECT_EQ(state.particles.rest[439], Vec3(other.particles.rest[7] + Vec3(3, 0, 0)));
}

/// So far out that the coordinates themselves step by more than the spacing.
std::string far_scene(const std::string& solver) {
  return "duration = 0.1\n[solver]\n" + solver +
         "[[body]]\nname = \"far\"\nshape = { type = \"box\", size = [2, 2, 2], resolution = 2 }\n"
         "position = [1e15, 0, 0]\nspacing = 0.1\ndensity = 1000\nelastic = { young = 1e6 }\n";
}

TEST(HardCase, Row06TheProgramMergesWithAWarning) {
  for (const std::string& solver : both_gradients) {
    Scratch scratch;
    Said said = deforma_program("check " + scratch.write("far.toml", far_scene(solver)).string());
    EXPECT_EQ(said.code, 0) << said.text;
    EXPECT_THAT(said.text,
                testing::ContainsRegex("warning: far: [0-9]+ particles stand where another one does"));
    World world = build_text(scratch, far_scene(solver));
    EXPECT_LT(world.bodies[0].particles, 8000u);
    EXPECT_NEAR(world.bodies[0].mass, 1000.0 * world.bodies[0].volume, 1e-12 * world.bodies[0].mass);
    EXPECT_TRUE(all_finite(world.solver->state()));
  }
}

TEST(HardCase, Row07AllParticlesInOnePoint) {
  for (Gradient gradient : {Gradient::linear, Gradient::quadratic})
    for (const Vec3& place : {Vec3(0, 0, 0), Vec3(0.1, -0.7, 1e5)}) {
      State state = lattice_particles(Vec3::Constant(0.6), 6, 6, 6, 1000.0);
      for (Vec3& rest : state.particles.rest) rest = place;
      const double mass = sum(state.particles.mass);
      EXPECT_EQ(merge_coincident(state.particles, state.bodies), std::vector<std::size_t>{215});
      ASSERT_EQ(state.size(), 1u);
      EXPECT_NEAR(state.particles.mass[0], mass, 1e-12 * mass);
      EXPECT_EQ(state.particles.rest[0], place);
      prepare_state(state, {}, {}, {}, gradient);
      auto effects = elastic_effects(state);
      Parameters gravity = given("gravity");
      for (auto& effect : make_effects(state, std::vector<EffectRequest>{{"gravity", {0, gravity}}}))
        effects.push_back(std::move(effect));
      Solver solver(std::move(state), std::move(effects), {});
      solver.advance(0.1);
      EXPECT_TRUE(all_finite(solver.state()));
      std::vector<Vec3> points(solver.state().surface.size());
      solver.deform(points);
      for (const Vec3& point : points) EXPECT_TRUE(point.allFinite());
      EXPECT_NEAR(solver.state().particles.displacement[0].z(), -0.5 * 9.81 * 0.01, 1e-9);
    }
}

TEST(HardCase, Row07AMeshInOnePointIsRefused) {
  Scratch scratch;
  // A box whose corners all round to one place.
  expect_run_refused(scratch,
                     "duration = 1\n[[body]]\nshape = { type = \"box\", size = [1, 1, 1] }\n"
                     "position = [1e18, 1e18, 1e18]\nparticles = 100\n",
                     {"scene.toml:2: body: ", "encloses no volume"});
}

}  // namespace
}  // namespace deforma
