#include <fmt/core.h>

#include <cmath>

#include "pipeline/validation_case.hpp"
#include "sim/material.hpp"

namespace deforma {

namespace {

constexpr double gravity = 9.81;  // m/s^2
const std::string gravity_lines = fmt::format("gravity = [0, 0, {}]\n", -gravity);

ValidationCase free_fall(std::string_view name, std::string_view integrator) {
  CubeSpec cube{.width = 0.4, .world = gravity_lines};
  cube.solver = fmt::format("integrator = \"{}\"\nmax_step = 1e-3\n", integrator);
  return {.name = name,
          .summary = "an elastic cube falls for 0.5 s",
          .sizes = {4, 6, 8, 10},
          .small = true,
          .weight = 1.0,
          .scene = [cube](const ValidationVariant& variant) { return cube_scene(cube, variant); },
          .mesh = {},
          .measure = [](const Scene& scene, World& world, const ValidationVariant&) -> Measured {
            constexpr double duration = 0.5;
            world.solver->advance(duration);
            const auto steps = static_cast<double>(world.solver->statistics().substeps);
            const double dt = duration / steps;
            const bool verlet = scene.solver.integrator == "velocity_verlet";
            const double expected =
                -gravity * (verlet ? 0.5 * duration * duration : 0.5 * dt * dt * steps * (steps + 1.0));
            double error = 0.0;
            for (const Vec3& u : world.solver->state().particles.displacement)
              error = std::max(error, (u - Vec3(0, 0, expected)).norm() / std::abs(expected));
            return {{{"relative error", error}}};
          }};
}

ValidationCase bounce() {
  CubeSpec cube{.width = 0.5, .world = gravity_lines};
  constexpr double drop = 0.5;  // m
  cube.height = drop + 0.5 * cube.width;
  cube.body = "contact = { friction = 0, restitution = 1 }\n";
  cube.more = "[ground]\nfriction = 0\n";
  return {.name = "bounce",
          .summary =
              "an elastic cube falls 0.5 m onto the ground and rises again, with substeps of 0.5 d/c at most",
          .sizes = {4, 6, 8, 10},
          .small = false,
          .weight = 3.0,
          .scene =
              [cube](const ValidationVariant& variant) {
                CubeSpec stepped = cube;
                const double c = std::sqrt(lame_constants(1e6, 0.3).p_wave_modulus() / cube.density);
                stepped.solver = fmt::format("max_step = {}\n", 0.5 * cube.width / variant.n / c);
                return cube_scene(stepped, variant);
              },
          .mesh = {},
          .measure = [cube](const Scene&, World& world, const ValidationVariant&) -> Measured {
            const double weight = world.bodies.front().mass * gravity * drop;
            const double begin = world.solver->ledger().total();
            double error = 0.0;
            for (int k = 0; k < 170; ++k) {  // 0.85 s: one bounce
              world.solver->advance(5e-3);
              error = std::max(error, std::abs(world.solver->ledger().total() - begin) / weight);
            }
            return {{{"energy error over mgh", error}}};
          }};
}

ValidationCase rotation() {
  CubeSpec cube{.body = "angular_velocity = [1, 2, 3]\n"};
  return {.name = "rotation",
          .summary = "an elastic cube of 6^3 particles turns freely for 1e5 substeps",
          .sizes = {6},
          .small = false,
          .weight = 100.0,
          .scene = [cube](const ValidationVariant& variant) { return cube_scene(cube, variant); },
          .mesh = {},
          .measure = [](const Scene&, World& world, const ValidationVariant&) -> Measured {
            Solver& solver = *world.solver;
            const Ledger begin = solver.ledger();
            double momentum = 0.0, angular = 0.0, energy = 0.0;
            while (solver.statistics().substeps < 100000) {
              solver.advance(1000.0 * solver.stable_step());
              const Ledger now = solver.ledger();
              const Particles& particles = solver.state().particles;
              double moving = 0.0;
              for (std::size_t i = 0; i < particles.size(); ++i)
                moving += particles.mass[i] * particles.velocity[i].norm();
              momentum = std::max(momentum, now.linear_momentum.norm() / moving);
              angular = std::max(angular, (now.angular_momentum - begin.angular_momentum).norm() /
                                              begin.angular_momentum.norm());
              energy = std::max(energy, std::abs(now.total() / begin.total() - 1.0));
            }
            return {{{"momentum over sum m |v|", momentum},
                     {"angular momentum, relative error", angular},
                     {"energy, relative error", energy}}};
          }};
}

}  // namespace

std::vector<ValidationCase> conservation_validation_cases() {
  return {free_fall("free-fall", "velocity_verlet"), free_fall("free-fall-euler", "symplectic_euler"),
          bounce(), rotation()};
}

}  // namespace deforma
