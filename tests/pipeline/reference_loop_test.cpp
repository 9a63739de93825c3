#include "pipeline/reference_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/bench_body.hpp"
#include "pipeline/build.hpp"

namespace deforma {
namespace {

using Code = ReferenceLoop::Code;

constexpr Gradient both_fits[] = {Gradient::linear, Gradient::quadratic};

BenchBody small_body(Gradient gradient, bool hourglass) {
  return {.across = {6, 7, 8}, .gradient = gradient, .links = bench_links, .hourglass = hourglass};
}

ReferenceMaterial material(const BenchBody& body) {
  return {bench_young, bench_poisson, body.hourglass ? body.usual_hourglass() : 0.0};
}

/// Large and uneven: strains of some ten per cent.
std::vector<Vec3> bent(const State& state) {
  std::vector<Vec3> u;
  for (const Vec3& X : state.particles.rest)
    u.push_back(0.1 * Vec3(std::sin(7 * X.y()), std::sin(5 * X.z() + 1), std::sin(6 * X.x() + 2)) +
                0.004 * Vec3(std::sin(91 * X.x()), std::sin(87 * X.y()), std::sin(99 * X.z())));
  return u;
}

double norm(std::span<const Vec3> vectors) {
  double sum = 0.0;
  for (const Vec3& v : vectors) sum += v.squaredNorm();
  return std::sqrt(sum);
}

double difference(std::span<const Vec3> a, std::span<const Vec3> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum);
}

TEST(ReferenceLoop, HasTheForcesOfTheProgramInEachCodeByEitherFit) {
  for (Gradient gradient : both_fits) {
    for (bool hourglass : {false, true}) {
      const BenchBody body = small_body(gradient, hourglass);
      World world = build(bench_scene(body));
      const std::vector<Vec3> u = bent(world.solver->state());
      std::vector<Vec3> ours(u.size()), theirs(u.size());
      world.solver->static_force(u, ours);
      ReferenceLoop reference(world.solver->state(), material(body));
      for (Code code : {Code::best, Code::portable, Code::eigen}) {
        reference.find_force(u, theirs, code);
        EXPECT_LT(difference(ours, theirs), 1e-9 * norm(ours)) << gradient_name(gradient) << hourglass;
        EXPECT_GT(norm(theirs), 0.0);
      }
    }
  }
}

TEST(ReferenceLoop, MovesAsTheProgramWithSymplecticEuler) {
  for (Gradient gradient : both_fits) {
    const BenchBody body = small_body(gradient, true);
    Scene scene = bench_scene(body);
    scene.solver.integrator = "symplectic_euler";
    scene.bodies[0].angular_velocity = Vec3(6, 4, 2);  // enough for strains of some per cent
    World world = build(scene);
    constexpr int steps = 20;
    const double dt = 0.5 * world.solver->stable_step();
    ReferenceLoop reference(world.solver->state(), material(body)),
        by_eigen(world.solver->state(), material(body));
    for (int step = 0; step < steps; ++step) world.solver->advance(dt);
    ASSERT_EQ(world.solver->statistics().substeps, steps);
    reference.advance(steps, dt);
    by_eigen.advance(steps, dt, Code::eigen);
    const std::vector<Vec3>& u = world.solver->state().particles.displacement;
    EXPECT_LT(difference(reference.displacement(), u), 1e-9 * norm(u)) << gradient_name(gradient);
    EXPECT_LT(difference(by_eigen.displacement(), u), 1e-9 * norm(u)) << gradient_name(gradient);
  }
}

TEST(ReferenceLoop, RefusesArraysOfAnotherLength) {
  World world = build(bench_scene(small_body(Gradient::linear, true)));
  ReferenceLoop reference(world.solver->state(), {});
  std::vector<Vec3> few(3), force(world.solver->state().size());
  EXPECT_THROW(reference.find_force(few, force), std::invalid_argument);
}

TEST(BenchBody, HasAsManyParticlesAndLinksAsAskedFor) {
  for (int particles : {300, 1000, 8000}) {
    BenchBody body = bench_box(particles);
    ASSERT_EQ(body.particles(), particles);
    body.links = bench_links;
    const World world = build(bench_scene(body));
    const State& state = world.solver->state();
    ASSERT_EQ(state.size(), static_cast<std::size_t>(particles));
    EXPECT_NEAR(static_cast<double>(state.links.links.size()) / particles, bench_links, 0.02 * bench_links);
    EXPECT_EQ(state.fit.count_below(3), 0u);
    EXPECT_THAT(world.warnings, testing::IsEmpty());
  }
}

TEST(BenchBody, IsNoSlenderBox) {
  EXPECT_EQ(bench_box(100000).particles(), 100000);
  EXPECT_EQ(bench_box(1000000).particles(), 1000000);
  for (int prime : {61, 1009, 64007}) {
    const auto [x, y, z] = bench_box(prime).across;
    EXPECT_EQ(x, y);
    EXPECT_EQ(y, z);
    EXPECT_NEAR(x * y * z, prime, 0.15 * prime);
  }
}

}  // namespace
}  // namespace deforma
