#include "sim/effects/contact.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fixtures.hpp"
#include "gradient_check.hpp"
#include "sim/solver.hpp"
#include "sphere_mesh.hpp"

namespace deforma {
namespace {

using Values = std::vector<std::pair<std::string_view, SettingValue>>;

EffectRequest contact_of(Index body, double friction, double restitution, Values more = {}) {
  more.emplace_back("friction", Curve<double>(friction));
  more.emplace_back("restitution", Curve<double>(restitution));
  return {"contact", {body, given("contact", std::move(more))}};
}

std::vector<EffectRequest> elastic_of(Index body, double young) {
  return {{"elastic", {body, given("elastic", {{"young", Curve<double>(young)}})}},
          {"hourglass", {body, given("hourglass")}}};
}

EffectRequest gravity_of(Index body, const Vec3& g) {
  return {"gravity", {body, given("gravity", {{"acceleration", Curve<Vec3>(g)}})}};
}

Solver make_solver(State state, const std::vector<EffectRequest>& requests,
                   const SolverSettings& settings = {}) {
  auto effects = make_effects(state, requests);
  return Solver(std::move(state), std::move(effects), settings);
}

// A cube of side 0.4 around the origin, jittered, with an obstacle that cuts into it.
State cube_in(const ObstacleShape& shape, const Vec3& position, const Vec3& rotation) {
  State state = lattice_particles(Vec3::Constant(0.4), 4, 4, 4, 1000.0, 0.2);
  for (Vec3& X : state.particles.rest) X -= Vec3::Constant(0.2);
  for (Vec3& X : state.surface.rest) X -= Vec3::Constant(0.2);
  Obstacle obstacle{.name = "it", .shape = shape};
  obstacle.position = position;
  obstacle.rotation = rotation;
  state.obstacles.push_back(obstacle);
  prepare_state(state, {});
  return state;
}

// One particle of mass 1 kg, its surface a cube of side 0.1 m around it.
State free_particle(const Vec3& at) {
  State state = lattice_particles(Vec3::Constant(0.1), 1, 1, 1, 1000.0);
  for (Vec3& X : state.particles.rest) X += at - Vec3::Constant(0.05);
  for (Vec3& X : state.surface.rest) X += at - Vec3::Constant(0.05);
  return state;
}

TEST(Contact, TheForceIsTheGradientOfTheEnergyAtEveryObstacle) {
  struct Case {
    std::string name;
    ObstacleShape shape;
    Vec3 position;
  };
  const Case cases[] = {
      {"plane", PlaneShape{Vec3(0.1, 0.2, 1)}, Vec3(0, 0, -0.18)},
      {"box", BoxShape{Vec3(0.3, 0.35, 0.2), false, false}, Vec3(0.03, 0.02, -0.27)},
      {"container box", BoxShape{Vec3(0.36, 0.37, 0.38), true, true}, Vec3::Zero()},
      {"cylinder", CylinderShape{0.15, 0.3, false, false}, Vec3(0.02, 0.3, 0.01)},
      {"container cylinder", CylinderShape{0.22, 0.38, true, false}, Vec3::Zero()},
      {"sphere", SphereShape{0.15, false}, Vec3(0.05, 0.02, 0.31)},
      {"container sphere", SphereShape{0.28, true}, Vec3::Zero()},
      {"mesh", sphere_mesh(0.15, 2), Vec3(0.05, 0.02, 0.31)},
  };
  for (const Case& c : cases) {
    State state = cube_in(c.shape, c.position, Vec3(0.3, -0.2, 0.1));
    scramble(state, 0.002);
    auto effects = make_effects(state, std::vector{contact_of(0, 0.0, 0.3)});
    EXPECT_LT(gradient_error(state, effects, 1e-6), 1e-6) << c.name;
    EXPECT_GT(total_energy(state, effects), 0.0) << c.name;
  }
}

// Two cubes, one turned and pressed into the other's side; restitution 1 and no friction.
State two_cubes(double overlap) {
  State state = lattice_particles(Vec3::Constant(0.4), 4, 4, 4, 1000.0, 0.1);
  State other = lattice_particles(Vec3::Constant(0.3), 3, 3, 3, 700.0, 0.1);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  double lowest = 1.0;
  for (Vec3& X : other.surface.rest) X = turn * (X - Vec3::Constant(0.15)), lowest = std::min(lowest, X.z());
  for (Vec3& X : other.particles.rest) X = turn * (X - Vec3::Constant(0.15));
  append_body(state, other, Vec3(0.21, 0.19, 0.4 - overlap - lowest));
  prepare_state(state, {});
  return state;
}

TEST(Contact, BetweenBodiesTheForceIsTheGradientOfTheEnergyAndKeepsMomentum) {
  State state = two_cubes(0.03);
  scramble(state, 0.001);
  std::vector<EffectRequest> requests = {contact_of(0, 0.0, 0.3), contact_of(1, 0.0, 0.3)};
  for (Index body : {0, 1})
    for (const EffectRequest& request : elastic_of(body, 1e5)) requests.push_back(request);
  auto effects = make_effects(state, requests);
  std::vector<std::unique_ptr<Effect>> contact;
  for (auto& effect : effects)
    if (effect->name() == "contact") contact.push_back(std::move(effect));
  EXPECT_LT(gradient_error(state, contact, 1e-7), 1e-6);
  std::vector<Vec3> force = total_force(state, contact);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  double size = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    sum += force[i];
    torque += state.particles.position(i).cross(force[i]);
    size += force[i].norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * size);
  EXPECT_LT(torque.norm(), 1e-12 * size);
  EXPECT_GT(size, 1.0);
}

TEST(Contact, AFreeParticleBouncesToTheSquareOfItsRestitution) {
  for (double e : {1.0, 0.7, 0.3}) {
    State state = free_particle(Vec3(0, 0, 0.55));
    state.obstacles.push_back({.name = "floor", .shape = PlaneShape{}});
    prepare_state(state, {});
    Solver solver = make_solver(std::move(state), {contact_of(0, 0.0, e), gravity_of(0, Vec3(0, 0, -9.81))});
    const double shell = 0.15 * 0.1;  // where contact begins
    const double drop = 0.5 - shell;
    bool bounced = false;
    double top = 0.0;
    for (int k = 0; k < 4000; ++k) {
      solver.advance(0.0002);
      double height = 0.5 + solver.state().particles.displacement[0].z() - shell;
      double velocity = solver.state().particles.velocity[0].z();
      bounced = bounced || velocity > 0.0;
      if (bounced) top = std::max(top, height);
      if (bounced && velocity < 0.0) break;
    }
    EXPECT_NEAR(top, e * e * drop, 0.01 * drop) << "restitution " << e;
  }
}

TEST(Contact, WithRestitutionOneAnElasticBodyKeepsItsEnergy) {
  State state = lattice_particles(Vec3::Constant(0.5), 5, 5, 5, 1000.0, 0.1);
  Obstacle floor{.name = "floor", .shape = PlaneShape{Vec3(0.2, 0.1, 1)}};
  floor.position = Vec3(0, 0, -0.2);
  state.obstacles.push_back(floor);
  prepare_state(state, {});
  for (Vec3& v : state.particles.velocity) v = Vec3(0, 0, -2);
  auto requests = elastic_of(0, 2e5);
  requests.push_back(contact_of(0, 0.0, 1.0));
  Solver solver = make_solver(std::move(state), requests, {.integrator = Integrator::velocity_verlet});
  const double before = solver.ledger().total();
  double deepest_contact = 0.0;
  for (int frame = 0; frame < 40; ++frame) {
    solver.advance(0.01);
    for (const auto& [name, energy] : solver.ledger().potential)
      if (name == "contact") deepest_contact = std::max(deepest_contact, energy);
  }
  EXPECT_GT(deepest_contact, 0.01 * before);
  EXPECT_NEAR(solver.ledger().total(), before, 0.01 * before);
  EXPECT_GT(solver.ledger().linear_momentum.z(), 0.0);
}

TEST(Contact, FrictionOnlyTakesEnergy) {
  State state = lattice_particles(Vec3::Constant(0.4), 4, 4, 4, 1000.0, 0.1);
  state.obstacles.push_back({.name = "floor", .shape = PlaneShape{}, .friction = 0.8});
  prepare_state(state, {});
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.velocity[i] = Vec3(1.5, 0.3, -0.5) + Vec3(0.5, 2, 1).cross(state.particles.rest[i]);
  auto requests = elastic_of(0, 1e5);
  requests.push_back(contact_of(0, 0.4, 0.3));
  requests.push_back(gravity_of(0, Vec3(0, 0, -9.81)));
  Solver solver = make_solver(std::move(state), requests, {.integrator = Integrator::velocity_verlet});
  double before = solver.ledger().total();
  const double start = before;
  for (int frame = 0; frame < 60; ++frame) {
    solver.advance(0.01);
    double now = solver.ledger().total();
    EXPECT_LT(now, before + 2e-3 * start) << "frame " << frame;
    before = now;
  }
  EXPECT_LT(before, 0.85 * start);
}

// A stiff block on a floor, gravity tilted.
State block_on_floor() {
  State state = lattice_particles(Vec3(0.6, 0.6, 0.2), 6, 6, 2, 1000.0);
  Obstacle floor{.name = "floor", .shape = PlaneShape{}};
  floor.position = Vec3(0, 0, -0.014);
  state.obstacles.push_back(floor);
  prepare_state(state, {});
  return state;
}

Vec3 mean_velocity(const State& state) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : state.particles.velocity) sum += v;
  return sum / static_cast<double>(state.size());
}

Vec3 mean_displacement(const State& state) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& u : state.particles.displacement) sum += u;
  return sum / static_cast<double>(state.size());
}

TEST(Contact, ASlidingBlockSlowsByMuG) {
  State state = block_on_floor();
  for (Vec3& v : state.particles.velocity) v = Vec3(3, 0, 0);
  auto requests = elastic_of(0, 1e6);
  requests.push_back(contact_of(0, 0.3, 0.0));
  requests.push_back(gravity_of(0, Vec3(0, 0, -9.81)));
  requests.push_back({"damping", {0, given("damping", {{"viscosity", Curve<double>(100.0)}})}});
  Solver solver = make_solver(std::move(state), requests);
  solver.advance(0.2);  // let it settle
  const double before = mean_velocity(solver.state()).x();
  solver.advance(0.5);
  const double slowed = before - mean_velocity(solver.state()).x();
  EXPECT_NEAR(slowed, 0.3 * 9.81 * 0.5, 0.01 * 0.3 * 9.81 * 0.5);
}

TEST(Contact, ABlockSticksBelowTheAngleOfFrictionAndSlidesAboveIt) {
  for (double slope : {0.2, 0.45}) {
    auto requests = elastic_of(0, 1e6);
    requests.push_back(contact_of(0, 0.3, 0.0));
    requests.push_back(gravity_of(0, 9.81 * Vec3(std::sin(slope), 0, -std::cos(slope))));
    requests.push_back({"damping", {0, given("damping", {{"viscosity", Curve<double>(100.0)}})}});
    Solver solver = make_solver(block_on_floor(), requests);
    solver.advance(0.5);
    const double before = mean_displacement(solver.state()).x();
    solver.advance(1.0);
    const double slid = mean_displacement(solver.state()).x() - before;
    if (slope < std::atan(0.3))
      EXPECT_LT(std::abs(slid), 1e-4);
    else
      EXPECT_GT(slid, 0.5 * (std::sin(slope) - 0.3 * std::cos(slope)) * 9.81 * 0.5);
  }
}

TEST(Contact, WhatIsPutOnTheFloorIsNotThrownOffIt) {
  State state = block_on_floor();
  state.obstacles[0].position = Vec3(0, 0, 0);
  auto requests = elastic_of(0, 1e6);
  requests.push_back(contact_of(0, 0.3, 0.3));
  requests.push_back(gravity_of(0, Vec3(0, 0, -9.81)));
  Solver solver = make_solver(std::move(state), requests);
  for (int frame = 0; frame < 50; ++frame) {
    solver.advance(0.01);
    EXPECT_LT(std::abs(mean_displacement(solver.state()).z()), 0.005);
  }
}

TEST(Contact, AMovingFloorCarriesWhatSticksToIt) {
  State state = block_on_floor();
  using Key = Curve<Vec3>::Key;
  const Vec3 down(0, 0, -0.014);
  state.obstacles[0].position =
      Curve<Vec3>(std::vector<Key>{{0.0, down}, {0.5, down}, {1.5, down + Vec3(0.5, 0, 0)}});
  auto requests = elastic_of(0, 1e6);
  requests.push_back(contact_of(0, 0.9, 0.0));
  requests.push_back(gravity_of(0, Vec3(0, 0, -9.81)));
  requests.push_back({"damping", {0, given("damping", {{"viscosity", Curve<double>(100.0)}})}});
  Solver solver = make_solver(std::move(state), requests);
  solver.advance(1.4);
  EXPECT_NEAR(mean_velocity(solver.state()).x(), 0.5, 0.01);
  EXPECT_NEAR(mean_displacement(solver.state()).x(), 0.45, 0.06);
}

TEST(Contact, BodiesThatCollideKeepTheirMomentum) {
  State state = two_cubes(-0.05);
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.velocity[i] = state.particles.body[i] == 1 ? Vec3(0.2, 0, -2) : Vec3(0, 0.1, 0);
  std::vector<EffectRequest> requests = {contact_of(0, 0.3, 0.5), contact_of(1, 0.5, 0.5)};
  for (Index body : {0, 1})
    for (const EffectRequest& request : elastic_of(body, body == 0 ? 1e5 : 4e5)) requests.push_back(request);
  Solver solver = make_solver(std::move(state), requests);
  const Ledger before = solver.ledger();
  solver.advance(0.4);
  const Ledger after = solver.ledger();
  EXPECT_LT((after.linear_momentum - before.linear_momentum).norm(), 1e-11 * before.linear_momentum.norm());
  EXPECT_LT(after.total(), 1.001 * before.total());
  Vec3 apart = Vec3::Zero();  // and they did collide
  for (std::size_t i = 0; i < solver.state().size(); ++i)
    apart += (solver.state().particles.body[i] == 1 ? 1.0 / 27.0 : -1.0 / 64.0) *
             solver.state().particles.velocity[i];
  EXPECT_GT(apart.z(), 0.1);
}

TEST(Contact, AStackOfBodiesComesToRestWithoutSinkingIn) {
  State state = lattice_particles(Vec3(0.4, 0.4, 0.2), 4, 4, 2, 1000.0);
  append_body(state, lattice_particles(Vec3(0.3, 0.3, 0.3), 3, 3, 3, 1000.0), Vec3(0.05, 0.05, 0.22));
  Obstacle floor{.name = "floor", .shape = PlaneShape{}};
  floor.position = Vec3(0, 0, -0.02);
  state.obstacles.push_back(floor);
  prepare_state(state, {});
  std::vector<EffectRequest> requests;
  for (Index body : {0, 1}) {
    for (const EffectRequest& request : elastic_of(body, 2e5)) requests.push_back(request);
    requests.push_back(contact_of(body, 0.5, 0.2));
    requests.push_back(gravity_of(body, Vec3(0, 0, -9.81)));
    requests.push_back({"damping", {body, given("damping", {{"viscosity", Curve<double>(100.0)}})}});
  }
  Solver solver = make_solver(std::move(state), requests);
  solver.advance(12.0);

  double mass = 0.0;
  for (double m : solver.state().particles.mass) mass += m;
  EXPECT_LT(solver.ledger().kinetic, 1e-6 * mass * 9.81 * 0.1);
  std::vector<Vec3> points(solver.state().surface.size());
  solver.deform(points);
  double bottom = 1.0, top = 0.0;
  for (std::size_t s = 0; s < points.size(); ++s) {
    if (solver.state().surface.body[s] == 1)
      bottom = std::min(bottom, points[s].z());
    else if (std::abs(points[s].x() - 0.2) < 0.1)
      top = std::max(top, points[s].z());
  }
  EXPECT_NEAR(bottom, top, 0.02);
  EXPECT_GT(bottom, 0.15);
}

TEST(Contact, AFastParticleNeverEndsUpBeyondAWall) {
  std::mt19937 generator(2);
  auto uniform = [&] { return generator() / 2147483648.0 - 1.0; };
  for (int k = 0; k < 1000; ++k) {
    Vec3 velocity(uniform(), uniform(), uniform());
    velocity *= 300.0 / std::max(velocity.norm(), 0.1);
    State state = free_particle(Vec3::Zero());
    for (Vec3& v : state.particles.velocity) v = velocity;
    state.obstacles.push_back({.name = "walls", .shape = BoxShape{Vec3(1.0, 1.2, 0.8), true, false}});
    prepare_state(state, {});
    Solver solver = make_solver(std::move(state), {contact_of(0, 0.3, 0.5)});
    for (int frame = 0; frame < 3; ++frame) {
      solver.advance(0.01);  // 30 spacings
      Vec3 x = solver.state().particles.position(0).cwiseAbs();
      ASSERT_TRUE((x.array() <= Vec3(0.5, 0.6, 0.4).array() + 0.05).all())
          << x.transpose() << " from " << velocity.transpose();
    }
  }
}

TEST(Contact, AnImpactAtTheSpeedOfSoundStaysFiniteAndOutsideTheWall) {
  const double young = 1e6, c = std::sqrt(young * 1.346 / 1000.0);
  for (double speed : {0.1, 0.5, 1.0, 2.0}) {
    State state = lattice_particles(Vec3::Constant(0.6), 6, 6, 6, 1000.0);
    Obstacle wall{.name = "wall", .shape = PlaneShape{}};
    wall.position = Vec3(0, 0, -0.05);
    state.obstacles.push_back(wall);
    prepare_state(state, {});
    for (Vec3& v : state.particles.velocity) v = Vec3(0, 0, -speed * c);
    auto requests = elastic_of(0, young);
    requests.push_back(contact_of(0, 0.3, 0.3));
    std::vector<Vec3> points(state.surface.size());
    Solver solver = make_solver(std::move(state), requests, {.integrator = Integrator::velocity_verlet});
    const double before = solver.ledger().total();
    for (int frame = 0; frame < 40; ++frame) {
      solver.advance(0.05 / c / speed);
      solver.deform(points);
      for (const Vec3& point : points) ASSERT_GT(point.z(), -0.05 - 0.05) << "speed " << speed;
      for (std::size_t i = 0; i < solver.state().size(); ++i)
        ASSERT_GT(solver.state().particles.position(i).z(), -0.05 - 0.1) << "speed " << speed;
      EXPECT_LT(solver.ledger().total(), 1.01 * before) << "speed " << speed << " frame " << frame;
    }
  }
}

TEST(Contact, NoVertexIsMissedHoweverTheBodyMoves) {
  // The same flight with the search repeated at every step must give the same forces.
  State state = lattice_particles(Vec3::Constant(0.4), 4, 4, 4, 1000.0);
  using Key = Curve<Vec3>::Key;
  Obstacle paddle{.name = "paddle", .shape = BoxShape{Vec3(0.2, 2.0, 0.2), false, false}};
  paddle.position = Vec3(0.9, 0.2, 0.2);
  paddle.rotation = Curve<Vec3>(std::vector<Key>{{0.0, Vec3(0, 0, 0)}, {1.0, Vec3(0, 0, 12)}});
  state.obstacles.push_back(paddle);
  prepare_state(state, {});
  State twin = state;
  auto kept = make_effects(state, std::vector{contact_of(0, 0.0, 0.3)});
  double felt = 0.0;
  for (int step = 0; step < 400; ++step) {
    state.time = twin.time = 0.0025 * step;
    for (std::size_t i = 0; i < state.size(); ++i)
      state.particles.displacement[i] = twin.particles.displacement[i] =
          Vec3(0.6 * std::sin(3.0 * state.time),
               0.1 * std::sin(20.0 * state.time) * state.particles.rest[i].x(), 0);
    std::vector<Vec3> force = total_force(state, kept);
    auto anew = make_effects(twin, std::vector{contact_of(0, 0.0, 0.3)});
    std::vector<Vec3> here = twin.particles.displacement;
    for (Vec3& u : twin.particles.displacement) u.z() += 100.0;
    total_force(twin, anew);  // so that it comes from afar
    twin.particles.displacement = here;
    std::vector<Vec3> expected = total_force(twin, anew);
    for (std::size_t i = 0; i < force.size(); ++i) {
      ASSERT_LT((force[i] - expected[i]).norm(), 1e-12 * (1.0 + expected[i].norm())) << "step " << step;
      felt = std::max(felt, force[i].norm());
    }
  }
  EXPECT_GT(felt, 1.0);
}

TEST(Contact, ABodyThatTouchesItselfIsStoppedByItself) {
  // A clamp: two plates joined on one side, pressed together.
  State state = lattice_particles(Vec3(0.8, 0.2, 0.7), 8, 2, 7, 1000.0);
  auto in_slot = [](const Vec3& X) { return X.x() > 0.2 && X.z() > 0.2 && X.z() < 0.5; };
  Particles slotted;
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (in_slot(state.particles.rest[i])) continue;
    slotted.rest.push_back(state.particles.rest[i]);
    slotted.mass.push_back(state.particles.mass[i]);
    slotted.volume.push_back(state.particles.volume[i]);
    slotted.body.push_back(0);
  }
  slotted.displacement.assign(slotted.rest.size(), Vec3::Zero());
  slotted.velocity.assign(slotted.rest.size(), Vec3::Zero());
  state.particles = slotted;
  state.bodies[0].particles = {0, static_cast<Index>(slotted.size())};
  // Three boxes' surfaces: what matters is that the slot's walls are there.
  state.surface = {};
  for (const auto& [size, corner, cells] :
       {std::tuple{Vec3(0.8, 0.2, 0.2), Vec3(0, 0, 0), Eigen::Vector3i(8, 2, 2)},
        {Vec3(0.8, 0.2, 0.2), Vec3(0, 0, 0.5), Eigen::Vector3i(8, 2, 2)}}) {
    std::size_t first = state.surface.rest.size();
    add_box_surface(state.surface, size, cells);
    for (std::size_t s = first; s < state.surface.rest.size(); ++s) state.surface.rest[s] += corner;
  }
  state.surface.body.assign(state.surface.size(), 0);
  state.bodies[0].vertices = {0, static_cast<Index>(state.surface.size())};
  state.bodies[0].triangles = {0, static_cast<Index>(state.surface.triangles.size())};
  LinkFilter across = [&](Index, const Vec3& a, const Vec3& b) { return !in_slot(0.5 * (a + b)); };
  prepare_state(state, {}, across, across);
  double gap[2];
  for (bool self : {false, true}) {
    auto requests = elastic_of(0, 1e5);
    requests.push_back(contact_of(0, 0.2, 0.2, {{"self", self}}));
    Region upper{.min = Vec3(0.5, -1, 0.65)}, lower{.max = Vec3(1, 1, 0.05)};
    lower.min.x() = 0.5;
    requests.push_back(
        {"load", {0, given("load", {{"force", Curve<Vec3>(Vec3(0, 0, -80))}, {"region", upper}})}});
    requests.push_back(
        {"load", {0, given("load", {{"force", Curve<Vec3>(Vec3(0, 0, 80))}, {"region", lower}})}});
    requests.push_back({"damping", {0, given("damping", {{"rate", Curve<double>(5.0)}})}});
    Solver solver = make_solver(state, requests);
    solver.advance(1.0);
    std::vector<Vec3> points(state.surface.size());
    solver.deform(points);
    double top_of_lower = -1.0, bottom_of_upper = 1.0;
    for (std::size_t s = 0; s < points.size(); ++s) {
      const Vec3& X = state.surface.rest[s];
      if (X.x() < 0.75 || std::abs(X.y() - 0.1) > 1e-9) continue;
      if (std::abs(X.z() - 0.2) < 1e-9) top_of_lower = std::max(top_of_lower, points[s].z());
      if (std::abs(X.z() - 0.5) < 1e-9) bottom_of_upper = std::min(bottom_of_upper, points[s].z());
    }
    gap[self] = bottom_of_upper - top_of_lower;
  }
  EXPECT_LT(gap[0], -0.05);  // the load does press one through the other
  EXPECT_GT(gap[1], -0.02);
}

TEST(Contact, RefusesABodyWithoutSurface) {
  State state = lattice_particles(Vec3::Constant(0.2), 2, 2, 2, 1000.0);
  state.surface = {};
  state.bodies[0].vertices = state.bodies[0].triangles = {};
  prepare_state(state, {});
  try {
    make_effects(state, std::vector{contact_of(0, 0.3, 0.3)});
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("body 'box' has none"));
  }
}

}  // namespace
}  // namespace deforma
