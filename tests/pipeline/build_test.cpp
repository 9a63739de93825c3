#include "pipeline/build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "assets/sample.hpp"
#include "assets/shapes.hpp"
#include "pipeline/build_body.hpp"
#include "pipeline/framing.hpp"
#include "pipeline/obstacle_mesh.hpp"
#include "pipeline/sight.hpp"
#include "pipeline/user_error.hpp"
#include "render/camera.hpp"
#include "sim/morton_order.hpp"
#include "tests/pipeline/mesh_text.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using testing::HasSubstr;

World build_text(const Scratch& scratch, const std::string& text) {
  return build(load_scene(scratch.write("scene.toml", text)));
}

/// Two boxes of one mesh, apart by `gap` along x.
Mesh two_boxes(double gap) {
  Mesh both = make_box(Vec3(1, 1, 1), 3), other = both;
  transform(other, Mat3::Identity(), Vec3::Ones(), Vec3(1 + gap, 0, 0));
  auto first = static_cast<Index>(both.points.size());
  both.points.insert(both.points.end(), other.points.begin(), other.points.end());
  for (const Triangle& t : other.triangles)
    both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return both;
}

TEST(Build, PosesScalesAndWeighsABody) {
  Scratch scratch;
  World world =
      build_text(scratch,
                 "duration = 1\n[[body]]\nshape = { type = \"box\", size = [1, 1, 1], resolution = 2 }\n"
                 "scale = [1, 2, 3]\nrotation = [0, 0, 90]\nposition = [5, 0, 0]\nparticles = 200\n"
                 "density = 500\n");
  const State& state = world.solver->state();
  Eigen::AlignedBox3d bounds;
  for (const Vec3& point : state.surface.rest) bounds.extend(point);
  EXPECT_NEAR((bounds.min() - Vec3(4, -0.5, -1.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((bounds.max() - Vec3(6, 0.5, 1.5)).norm(), 0.0, 1e-12);
  for (const Vec3& point : state.particles.rest) EXPECT_TRUE(bounds.contains(point));
  EXPECT_EQ(world.bodies[0].particles, 200u);
  EXPECT_NEAR(world.bodies[0].volume, 6.0, 1e-9);
  EXPECT_NEAR(world.bodies[0].mass, 3000.0, 1e-6);
}

TEST(Build, TurnsAboutTheCentreOfMass) {
  Scratch scratch;
  World world =
      build_text(scratch,
                 "duration = 1\n[[body]]\nshape = { type = \"sphere\", radius = 0.5 }\nparticles = 150\n"
                 "position = [3, 0, 0]\nvelocity = [1, 2, 3]\nangular_velocity = [0, 0, 4]\n");
  Ledger ledger = world.solver->ledger();
  double mass = world.bodies[0].mass;
  EXPECT_NEAR((ledger.linear_momentum - mass * Vec3(1, 2, 3)).norm(), 0.0, 1e-9 * mass);
  double spin_energy = ledger.kinetic - 0.5 * mass * 14.0;
  double solid_sphere = 0.5 * 0.4 * mass * 0.25 * 16.0;
  EXPECT_NEAR(spin_energy, solid_sphere, 0.1 * solid_sphere);
}

TEST(Build, MakesTheSurfaceAsFineAsAsked) {
  Scratch scratch;
  std::string body =
      "duration = 1\n[[body]]\nshape = { type = \"octahedron\", radius = 1, resolution = 1 }\nparticles = "
      "50\n";
  EXPECT_EQ(build_text(scratch, body).bodies[0].triangles, 8u);
  EXPECT_EQ(build_text(scratch, body + "subdivide = 2\n").bodies[0].triangles, 128u);
  World fine = build_text(scratch, body + "surface_particles = 60\n");
  EXPECT_GE(fine.bodies[0].vertices, 60u);
  EXPECT_EQ(fine.bodies[0].triangles, 128u);
}

TEST(Build, OrdersParticlesAlongACurveEachWithItsCell) {
  Scratch scratch;
  const std::string text =
      "duration = 1\n[solver]\ngradient = \"%\"\n[[body]]\nshape = { type = \"sphere\", radius = 0.5 }\n"
      "particles = 300\ndensity = 1000\n";
  auto with = [&](const char* gradient) { return std::string(text).replace(text.find('%'), 1, gradient); };
  const World quadratic = build_text(scratch, with("quadratic")),
              linear = build_text(scratch, with("linear"));
  const Particles& particles = quadratic.solver->state().particles;
  const Scene scene = load_scene(scratch.write("scene.toml", with("linear")));
  std::vector<std::string> warnings;
  const Sampling sampling = sample_interior(make_body_mesh(scene.bodies[0], warnings), {300, 0.0});

  const std::vector<Index> order = morton_order(sampling.points);
  ASSERT_EQ(particles.size(), order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const CellMoments& cell = sampling.cells[order[i]];
    EXPECT_EQ(particles.rest[i], sampling.points[order[i]]);
    EXPECT_EQ(particles.volume[i], cell.volume);
    EXPECT_EQ(particles.mass[i], 1000.0 * cell.volume);
    EXPECT_EQ(particles.cells[i].first, cell.first);
    EXPECT_EQ(particles.cells[i].second, cell.second);
  }
  EXPECT_EQ(linear.solver->state().particles.rest, particles.rest);
  EXPECT_TRUE(linear.solver->state().particles.cells.empty());
}

TEST(Build, TheWorldsEffectsHoldForBodiesThatDoNotRefuseThem) {
  Scratch scratch;
  World world = build_text(scratch,
                           "duration = 1\n[world]\ngravity = [0, 0, -10]\n"
                           "[[body]]\nshape = { type = \"sphere\", radius = 0.1 }\nparticles = 10\n"
                           "[[body]]\nshape = { type = \"sphere\", radius = 0.1 }\nparticles = 10\n"
                           "position = [1, 0, 0]\ngravity = false\n"
                           "[[body]]\nshape = { type = \"sphere\", radius = 0.1 }\nparticles = 10\n"
                           "position = [2, 0, 0]\ngravity = [0, 0, 5]\n");
  world.solver->advance(0.1);
  const State& state = world.solver->state();
  for (std::size_t b = 0; b < 3; ++b) {
    double expected[] = {-1.0, 0.0, 0.5};
    EXPECT_NEAR(state.particles.velocity[state.bodies[b].particles.begin].z(), expected[b], 1e-9) << b;
  }
}

TEST(Build, EffectsThatNoTableAsksForDoNotExist) {
  Scratch scratch;
  std::set<std::string> names;
  World world = build_text(scratch, small_scene());
  for (const auto& effect : world.solver->effects()) names.insert(std::string(effect->name()));
  EXPECT_EQ(names, (std::set<std::string>{"elastic", "hourglass", "gravity", "contact"}));
}

TEST(Build, LinksNeverJoinSeparatePieces) {
  Scratch scratch;
  scratch.write("two.obj", obj_text(two_boxes(0.05)));
  // The body before it is convex and sees everything: whose links are asked for matters.
  World world = build_text(scratch,
                           "duration = 1\n[[body]]\nshape = { type = \"sphere\", radius = 0.1 }\n"
                           "position = [-5, 0, 0]\nparticles = 20\n"
                           "[[body]]\nmesh = \"two.obj\"\nparticles = 400\n");
  const State& state = world.solver->state();
  auto right = [&](std::size_t i) { return state.particles.rest[i].x() > 0.525; };
  std::size_t links = 0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    Range row = state.links.row(i);
    for (Index k = row.begin; k < row.end; ++k, ++links) EXPECT_EQ(right(i), right(state.links.links[k].j));
  }
  EXPECT_GT(links, 400u);
  for (std::size_t s = 0; s < state.surface.size(); ++s)
    for (const Skin::Tie& tie : state.surface.skin.row(s))
      EXPECT_EQ(right(tie.particle), state.surface.rest[s].x() > 0.525);
}

TEST(Build, TurnsAnInsideOutMeshRound) {
  Scratch scratch;
  Mesh mesh = make_box(Vec3(1, 1, 1), 2);
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  scratch.write("box.obj", obj_text(mesh));
  World world = build_text(scratch, "duration = 1\n[[body]]\nmesh = \"box.obj\"\nparticles = 30\n");
  EXPECT_THAT(world.warnings, testing::Contains(HasSubstr("inside-out")));
  const Surface& surface = world.solver->state().surface;
  EXPECT_GT(inspect({surface.rest, surface.triangles}).volume, 0.99);
}

TEST(Build, RefusesWithThePlaceInTheScene) {
  Scratch scratch;
  scratch.write("text.obj", "no mesh\n");
  auto refusal = [&](const std::string& text) -> std::string {
    try {
      build_text(scratch, text);
    } catch (const UserError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("duration = 1\n[[body]]\nparticles = 9\nmesh = \"text.obj\"\n"),
              HasSubstr("scene.toml:4: body.mesh: "));
  EXPECT_THAT(
      refusal("duration = 1\n[[body]]\nparticles = 9\nshape = { type = \"box\", size = [1, -1, 1] }\n"),
      HasSubstr("scene.toml:4: body.shape: "));
  EXPECT_THAT(refusal("duration = 1\n[[body]]\nspacing = 50\nshape = { type = \"box\", size = [1, 1, 1] }\n"),
              HasSubstr("scene.toml:2: body: "));
  EXPECT_THAT(
      refusal("duration = 1\n[[body]]\nparticles = 9\nshape = { type = \"box\", size = [1, 1, 1] }\n"
              "[[obstacle]]\nshape = { type = \"mesh\", file = \"text.obj\" }\nposition = [9, 0, 0]\n"),
      HasSubstr("scene.toml:6: obstacle.shape.file: "));
}

TEST(Build, AnEffectThatCannotBeMadeIsToldAtItsOwnTable) {
  Scratch scratch;
  std::string ball = "[[body]]\nshape = { type = \"sphere\", radius = 0.1 }\nparticles = 20\n";
  std::string text = "duration = 1\n" + ball + "pin = true\n" + ball +
                     "position = [1, 0, 0]\npin = [{ region = { min = [0, -9, -9] } },\n"
                     "{ region = { min = [5, 5, 5] } }]\n";
  try {
    build_text(scratch, text);
    FAIL() << "accepted";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scene.toml:11: body.pin: "));
  }
}

/// The displacements after a while.
std::vector<Vec3> moved(World world) {
  world.solver->advance(0.2);
  return world.solver->state().particles.displacement;
}

TEST(Build, TheResolvedSceneMovesAsTheScene) {
  Scratch scratch;
  // Where a pin turns about is computed, unless the scene says it: each alone, away from the origin.
  for (std::string center : {"", ", center = [3, 0, 1]"}) {
    Scene scene = load_scene(scratch.write(
        "scene.toml",
        "duration = 1\n[[body]]\nshape = { type = \"box\", size = [0.6, 0.2, 0.2] }\n"
        "position = [3, 0, 1]\nparticles = 60\nelastic = { young = 1e5 }\n"
        "pin = { region = { min = [3.1, -9, -9] }, rotation = [[0, [0, 0, 0]], [1, [90, 0, 0]]]" +
            center + " }\nload = { force = [0, 0, 1] }\n"));
    std::vector<Vec3> first = moved(build(scene));
    EXPECT_EQ(moved(build_text(scratch, scene_to_toml(scene))), first) << center;
    double farthest = 0.0;
    for (const Vec3& u : first) farthest = std::max(farthest, u.norm());
    EXPECT_GT(farthest, 0.02);
    EXPECT_LT(farthest, 0.5);
  }
}

TEST(Sight, ConvexIsToldFromNot) {
  EXPECT_TRUE(is_convex(make_box(Vec3(1, 2, 3), 4)));
  EXPECT_TRUE(is_convex(make_octahedron(1.0, 3)));
  EXPECT_FALSE(is_convex(make_torus(1.0, 0.3, 12, 8)));
  EXPECT_FALSE(is_convex(two_boxes(0.1)));
  Mesh dented = make_box(Vec3(1, 1, 1), 2);
  for (Vec3& point : dented.points)
    if (point.z() > 0.4 && point.head<2>().norm() < 0.1) point.z() = 0.3;
  EXPECT_FALSE(is_convex(dented));
}

TEST(Framing, TheWholeSceneIsInThePicture) {
  Scratch scratch;
  for (const char* size : {"[320, 240]", "[640, 200]", "[100, 300]"}) {
    Scene scene = load_scene(
        scratch.write("scene.toml", small_scene("",
                                                "[[obstacle]]\nshape = { type = \"sphere\", radius = 0.2 }\n"
                                                "position = [[0, [1, 0, 0.2]], [1, [-2, 0, 0.2]]]\n")),
        {{"output.size", size, "test"}});
    World world = build(scene);
    frame_scene(scene, world.solver->state());
    Camera camera = camera_at(scene.camera, 0.0);
    double aspect = static_cast<double>(scene.output.width) / scene.output.height;
    Eigen::Matrix4d to_clip = projection_matrix(camera, aspect, 0.01, 100.0) * view_matrix(camera);
    std::vector<Vec3> points = world.solver->state().surface.rest;
    for (double x : {1.2, -2.2}) points.emplace_back(x, 0, 0.2);
    for (const Vec3& point : points) {
      Eigen::Vector4d clip = to_clip * point.homogeneous();
      EXPECT_GT(clip.w(), 0.0);
      EXPECT_LE(std::abs(clip.x()), clip.w()) << size;
      EXPECT_LE(std::abs(clip.y()), clip.w()) << size;
    }
  }
}

TEST(Framing, AnOrthographicPictureHoldsTheSceneWhicheverWayItTurns) {
  Scratch scratch;
  Scene scene = load_scene(scratch.write("scene.toml", small_scene()),
                           {{"camera", "{ projection = \"orthographic\", orbit = 360 }", "test"}});
  World world = build(scene);
  frame_scene(scene, world.solver->state());
  double aspect = static_cast<double>(scene.output.width) / scene.output.height;
  for (double time : {0.0, 0.125, 0.25, 0.6}) {
    Camera camera = camera_at(scene.camera, time);
    EXPECT_TRUE(camera.is_parallel());
    Eigen::Matrix4d to_clip = projection_matrix(camera, aspect, -100.0, 100.0) * view_matrix(camera);
    for (const Vec3& point : world.solver->state().surface.rest) {
      Eigen::Vector4d clip = to_clip * point.homogeneous();
      EXPECT_LE(std::abs(clip.x()), 1.0);
      EXPECT_LE(std::abs(clip.y()), 1.0);
    }
  }
}

TEST(Framing, TheCameraFollowsKeyframesAndOrbitsItsTarget) {
  CameraSpec spec;
  spec.position = Curve<Vec3>({{0.0, Vec3(2, 0, 1)}, {2.0, Vec3(4, 0, 1)}});
  spec.target = Vec3(1, 0, 0);
  EXPECT_EQ(camera_at(spec, 1.0).eye, Vec3(3, 0, 1));
  spec.orbit = 90.0;  // a quarter turn to the left after 1 s, seen from above
  EXPECT_LT((camera_at(spec, 1.0).eye - Vec3(1, 2, 1)).norm(), 1e-12);
  EXPECT_EQ(camera_at(spec, 1.0).target, Vec3(1, 0, 0));
}

TEST(ObstacleMesh, ContainersOpenUpwardsAndFaceInwards) {
  Mesh closed = make_obstacle_mesh(BoxShape{Vec3(1, 2, 3)}, 1.0);
  EXPECT_EQ(closed.triangles.size(), 12u);
  EXPECT_NEAR(inspect(closed).volume, 6.0, 1e-12);
  EXPECT_NEAR(inspect(make_obstacle_mesh(BoxShape{Vec3(1, 2, 3), true, false}, 1.0)).volume, -6.0, 1e-12);
  Mesh open = make_obstacle_mesh(BoxShape{Vec3(1, 2, 3), true, true}, 1.0);
  EXPECT_EQ(open.triangles.size(), 10u);
  for (const Triangle& t : open.triangles)
    EXPECT_LT((open.points[t[0]] + open.points[t[1]] + open.points[t[2]]).z() / 3, 1.4);
  double circle = 3.14159265 * 0.25;
  EXPECT_NEAR(inspect(make_obstacle_mesh(CylinderShape{0.5, 2.0}, 1.0)).volume, 2 * circle, 0.01);
  EXPECT_NEAR(inspect(make_obstacle_mesh(CylinderShape{0.5, 2.0, true, false}, 1.0)).volume, -2 * circle,
              0.01);
  EXPECT_NEAR(inspect(make_obstacle_mesh(PlaneShape{Vec3(0, 1, 1)}, 3.0)).area, 9.0, 1e-9);
}

}  // namespace
}  // namespace deforma
