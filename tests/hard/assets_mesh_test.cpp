#include <numbers>
#include <numeric>

#include "assets/import.hpp"
#include "assets/sample.hpp"
#include "assets/shapes.hpp"
#include "assets/weld.hpp"
#include "tests/assets/fixtures.hpp"
#include "tests/hard/refusal.hpp"
#include "tests/pipeline/mesh_text.hpp"

namespace deforma {
namespace {

using testing::Contains;
using testing::HasSubstr;

const std::vector<std::pair<std::string, Arrangement>> arrangements = {
    {"lattice", Arrangement::lattice},
    {"body_centered", Arrangement::body_centered},
    {"blue_noise", Arrangement::blue_noise}};

/// A prism of height 1 over an outline that may cross itself; both ends as fans.
Mesh prism(const std::vector<std::array<double, 2>>& outline) {
  Mesh mesh;
  auto n = static_cast<std::uint32_t>(outline.size());
  for (double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) mesh.points.emplace_back(x, y, z);
  for (std::uint32_t i = 0; i < n; ++i) {
    std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, next + n});
    mesh.triangles.push_back({i, next + n, i + n});
    if (i == 0 || next == 0) continue;
    mesh.triangles.push_back({0, next, i});
    mesh.triangles.push_back({n, i + n, next + n});
  }
  return mesh;
}

template <typename Keep>
Mesh without(Mesh mesh, const Keep& dropped) {
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return dropped(Vec3((mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3.0));
  });
  return mesh;
}

/// A box whose top is drawn down in the middle, out through its bottom: there it is inside out.
Mesh pierced_box() {
  Mesh mesh = make_box({1, 1, 1}, 4);
  for (Vec3& p : mesh.points)
    if (p.z() > 0.49 && p.head<2>().norm() < 0.01) p.z() = -0.7;
  return mesh;
}

/// What a box loses to the dent and gains by the spike below it.
double pierced_volume() {
  const Mesh mesh = make_box({1, 1, 1}, 4);
  double base = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    auto is_center = [](const Vec3& p) { return p.z() > 0.49 && p.head<2>().norm() < 0.01; };
    if (is_center(a) || is_center(b) || is_center(c)) base += 0.5 * (b - a).cross(c - a).norm();
  }
  const double pyramid = base * 1.2 / 3.0, spike = pyramid * std::pow(0.2 / 1.2, 3);
  return 1.0 - (pyramid - spike) + spike;
}

struct Oddity {
  std::string name;
  Mesh mesh;
  std::string warning;
  double volume;  ///< 0: none is prescribed, for it is open
};

std::vector<Oddity> oddities() {
  const Mesh ball = make_sphere(1, 16);
  Mesh fin = make_octahedron(1, 4);
  fin.points.emplace_back(2, 2, 0);
  fin.triangles.push_back(
      {fin.triangles[0][0], fin.triangles[0][1], static_cast<std::uint32_t>(fin.points.size() - 1)});
  Mesh turned = make_box({1, 1, 1}, 4);
  for (std::size_t t = 0; t < turned.triangles.size(); t += 7)
    std::swap(turned.triangles[t][0], turned.triangles[t][1]);
  Mesh cubes = merged(make_box({1, 1, 1}, 1), moved(make_box({1, 1, 1}, 1), {1, 1, 0}));
  Mesh wall = merged(make_box({1, 1, 1}, 1), without(moved(make_box({1, 1, 1}, 1), {1, 0, 0}),
                                                     [](const Vec3& p) { return p.x() < 0.6; }));
  const double ball_volume = inspect(ball).volume;
  const double lens = std::numbers::pi * 5.0 / 12.0;  // of unit balls 1 apart
  std::vector<Oddity> all = {
      {"a hole", without(ball, [](const Vec3& p) { return p.z() > 0.9; }), "boundary edges", 0.0},
      {"half a ball", without(ball, [](const Vec3& p) { return p.z() > 0.0; }), "boundary edges", 0.0},
      {"no lid", without(make_box({1, 1, 1}, 6), [](const Vec3& p) { return p.z() > 0.49; }),
       "boundary edges", 0.0},
      {"holes all over", without(ball, [](const Vec3& p) { return std::sin(40 * p.x() + 23 * p.y()) > 0.9; }),
       "boundary edges", 0.0},
      {"a fin", fin, "1 edges where more than two triangles meet", 0.0},
      {"triangles turned round", turned, "disagree about their outside", 0.0},
      {"a wall inside", wall, "more than two triangles meet", 0.0},
      {"cubes sharing an edge", cubes, "more than two triangles meet", 2.0},
      {"two balls", merged(ball, moved(ball, {1, 0, 0})), "overlap", 2.0 * ball_volume - lens},
      {"a ball in a ball", merged(ball, make_sphere(0.5, 9)), "overlap", ball_volume},
      {"a pierced box", pierced_box(), "face opposite ways", pierced_volume()},
      {"a bow tie", prism({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), "face opposite ways", 0.5},
      {"a star",
       prism({{1, 0},
              {-0.809016994, 0.587785252},
              {0.309016994, -0.951056516},
              {0.309016994, 0.951056516},
              {-0.809016994, -0.587785252}}),
       "overlap", 1.12256994},
  };
  for (Oddity& oddity : all) weld(oddity.mesh);
  return all;
}

TEST(HardCase, Row25OpenNonManifoldAndSelfIntersectingMeshes) {
  Scratch scratch;
  for (const Oddity& oddity : oddities()) {
    SCOPED_TRACE(oddity.name);
    MeshFacts facts = inspect(oddity.mesh);
    std::vector<SamplingSettings> all_settings = {{0, 0.12, Arrangement::lattice}};
    for (const auto& [name, arrangement] : arrangements) all_settings.push_back({400, 0.0, arrangement});
    for (const SamplingSettings& settings : all_settings) {
      Sampling sampling = sample_interior(oddity.mesh, settings);
      EXPECT_THAT(sampling.warnings, Contains(HasSubstr(oddity.warning)));
      if (facts.boundary_edges > 0) {
        EXPECT_THAT(sampling.warnings,
                    Contains(HasSubstr("has " + std::to_string(facts.boundary_edges) + " boundary edges")));
      }
      double volume = sampling.volume();
      EXPECT_TRUE(std::isfinite(volume) && volume > 0.0);
      if (oddity.volume > 0.0) {
        EXPECT_NEAR(volume, oddity.volume, 0.02 * oddity.volume);
      }
      ASSERT_FALSE(sampling.points.empty());
      if (settings.particles > 0) {
        EXPECT_EQ(sampling.points.size(), settings.particles);
      }
      for (const Vec3& p : sampling.points)
        EXPECT_TRUE((p.array() >= facts.min.array()).all() && (p.array() <= facts.max.array()).all())
            << p.transpose();
    }
    // And as a file, by the program, to the end: it moves and stays finite.
    scratch.write("odd.obj", obj_text(oddity.mesh));
    for (const std::string& solver : both_gradients) {
      World world = build_text(scratch, mesh_scene("odd.obj",
                                                   "particles = 200\nelastic = { young = 1e5 }\n"
                                                   "angular_velocity = [1, 2, 3]",
                                                   solver));
      world.solver->advance(0.02);
      EXPECT_TRUE(all_finite(world.solver->state()));
    }
    Said said = deforma_program(
        "check " + scratch.write("scene.toml", mesh_scene("odd.obj", "particles = 60")).string());
    EXPECT_EQ(said.code, 0) << said.text;
    EXPECT_THAT(said.text, HasSubstr("warning: "));
    EXPECT_THAT(said.text, HasSubstr(oddity.warning));
  }
}

/// Six sides each way: a hexagon's prism from `bottom` to `top`, its vertices 1 to 12 or counted from the end.
std::string hexagons(bool from_the_end) {
  std::ostringstream text;
  text.precision(9);
  for (int z : {0, 1})
    for (int i = 0; i < 6; ++i)
      text << "v " << std::cos(i * std::numbers::pi / 3) << " " << std::sin(i * std::numbers::pi / 3) << " "
           << z << "\n";
  auto vertex = [&](int i) { return from_the_end ? i - 13 : i; };
  text << "f";
  for (int i = 6; i >= 1; --i) text << " " << vertex(i);
  text << "\nf";
  for (int i = 7; i <= 12; ++i) text << " " << vertex(i);
  text << "\n";
  for (int i = 1; i <= 6; ++i) {
    int next = i % 6 + 1;
    text << "f " << vertex(i) << " " << vertex(next) << " " << vertex(next + 6) << " " << vertex(i + 6)
         << "\n";
  }
  return text.str();
}

/// The same prism with corners of its own for every face, as exporters write it.
std::string separate_faces() {
  std::ostringstream text;
  Mesh mesh = make_box({1, 1, 1}, 2);
  text.precision(9);
  for (const auto& t : mesh.triangles) {
    for (std::uint32_t corner : t)
      text << "v " << mesh.points[corner].x() << " " << mesh.points[corner].y() << " "
           << mesh.points[corner].z() << "\n";
    text << "f -3 -2 -1\n";
  }
  return text.str();
}

TEST(HardCase, Row26DuplicatesZeroAreaPolygonsAndNegativeIndices) {
  Scratch scratch;
  struct Case {
    std::string name, text;
    std::size_t welded, dropped, polygons;
    double volume;
  };
  const double hexagon = 1.5 * std::sqrt(3.0);
  // Zero area in every way: one corner twice, three on a line, a second corner in one place, all three in one.
  const std::string flat =
      "v 0.5 0 0\nv 1 0 0\nv 1 0 0\nf 1 1 2\nf 1 13 4\nf 1 14 15\nf 14 15 1\nf 1 4 13\nf 14 15 14\n";
  // The reader gives each of a face's corners a point of its own: 36 of the 12 that a prism has.
  const std::vector<Case> cases = {
      {"polygons", hexagons(false), 24, 0, 8, hexagon},
      {"negative indices", hexagons(true), 24, 0, 8, hexagon},
      {"duplicated vertices", separate_faces(), 3 * 48 - 26, 0, 0, 1.0},
      {"zero area", hexagons(false) + flat, 41, 6, 8, hexagon},
  };
  for (const Case& given : cases) {
    SCOPED_TRACE(given.name);
    const auto file = scratch.write("odd.obj", given.text);
    Imported imported = import_mesh(file);
    EXPECT_EQ(imported.welded_points, given.welded);
    EXPECT_EQ(imported.dropped_triangles, given.dropped);
    EXPECT_EQ(imported.polygons, given.polygons);
    MeshFacts facts = inspect(imported.mesh);
    EXPECT_EQ(facts.boundary_edges, 0u);
    EXPECT_EQ(facts.non_manifold_edges, 0u);
    EXPECT_NEAR(facts.volume, given.volume, 1e-6 * given.volume);
    std::string counted = std::to_string(given.dropped) + " triangles without area were left out";
    EXPECT_EQ(imported.warnings.empty(), given.dropped == 0);
    if (given.dropped > 0) {
      EXPECT_THAT(imported.warnings, Contains(HasSubstr(counted)));
    }
    std::vector<Vec3> normals(imported.mesh.points.size());
    vertex_normals(imported.mesh.points, imported.mesh.triangles, normals);
    for (const Vec3& normal : normals) EXPECT_NEAR(normal.norm(), 1.0, 1e-12);

    // Moved, so that the normals that are drawn are of a deformed surface.
    for (const std::string& solver : both_gradients) {
      World world = build_text(scratch, mesh_scene("odd.obj",
                                                   "particles = 150\nelastic = { young = 1e5 }\n"
                                                   "angular_velocity = [1, 2, 3]",
                                                   solver));
      world.solver->advance(0.05);
      EXPECT_TRUE(all_finite(world.solver->state()));
      std::vector<Vec3> points(world.solver->state().surface.size());
      world.solver->deform(points);
      normals.resize(points.size());
      vertex_normals(points, world.solver->state().surface.triangles, normals);
      for (const Vec3& normal : normals) EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
    }
    Said said = deforma_program("mesh " + file.string());
    EXPECT_EQ(said.code, 0) << said.text;
  }
}

TEST(HardCase, Row28AnInsideOutMeshIsSampledAsItsTwin) {
  Scratch scratch;
  for (const auto& [shape, mesh] :
       {std::pair<std::string, Mesh>{"ellipsoid", make_ellipsoid({0.5, 0.4, 0.3}, 9)},
        {"box", make_box({1, 0.7, 0.5}, 5)},
        {"torus", make_torus(0.5, 0.2, 24, 12)}})
    for (const auto& [name, arrangement] : arrangements) {
      SCOPED_TRACE(shape + ", " + name);
      for (const SamplingSettings& settings :
           {SamplingSettings{300, 0.0, arrangement}, SamplingSettings{0, 0.08, arrangement}}) {
        Sampling right = sample_interior(mesh, settings), wrong = sample_interior(flipped(mesh), settings);
        EXPECT_EQ(right.points, wrong.points);
        ASSERT_EQ(right.cells.size(), wrong.cells.size());
        for (std::size_t i = 0; i < right.cells.size(); ++i)
          EXPECT_EQ(right.cells[i].volume, wrong.cells[i].volume);
      }
      scratch.write("right.obj", obj_text(mesh));
      scratch.write("wrong.obj", obj_text(flipped(mesh)));
      std::string body = "particles = 200\nelastic = { young = 1e5 }\nsampling = \"" + name + "\"\n";
      for (const std::string& solver : both_gradients) {
        World right = build_text(scratch, mesh_scene("right.obj", body, solver));
        World wrong = build_text(scratch, mesh_scene("wrong.obj", body, solver));
        EXPECT_THAT(wrong.warnings, Contains(HasSubstr("inside-out")));
        EXPECT_EQ(right.solver->state().particles.rest, wrong.solver->state().particles.rest);
        EXPECT_EQ(right.solver->state().particles.mass, wrong.solver->state().particles.mass);
      }
    }
}

TEST(HardCase, Row29TrianglesAndFlatSquaresHaveNoVolume) {
  Scratch scratch;
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const std::vector<std::pair<std::string, int>> flat = {
      {corners + "f 1 2 3\n", 3},
      {corners + "f 1 2 3\nf 1 3 4\n", 4},
      {corners + "f 1 2 3\nf 4 3 2\n", 4},
      {corners + "f 1 2 3 4\n", 4},
      {corners + "f 1 2 3 4\nf 4 3 2 1\n", 0},            // both sides: closed, and yet nothing is in it
      {"v 0 0 0\nv 1 0 0.3\nv 0.2 1 0.7\nf 1 2 3\n", 3},  // not along an axis
      {"v 0 0 0\nv 1 0 0.3\nv 0.2 1 0.7\nv 1.2 1 1\nf 1 2 3\nf 3 2 4\n", 4},
      {"v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3\nf 1 3 4\n", 4},  // folded
  };
  for (const auto& [text, boundary] : flat)
    for (std::string amount : {"particles = 100", "spacing = 0.1"})
      for (const auto& [name, arrangement] : arrangements) {
        scratch.write("flat.obj", text);
        expect_run_refused(scratch, mesh_scene("flat.obj", amount + "\nsampling = \"" + name + "\""),
                           {"scene.toml:8: body: the mesh encloses no volume",
                            std::to_string(boundary) + " boundary edges"});
      }
}

TEST(HardCase, Row30AShellThinnerThanTheSpacing) {
  Scratch scratch;
  const Mesh box = make_box({1, 1, 1}, 4);
  const std::vector<std::pair<std::string, Mesh>> shells = {
      {"sphere", merged(make_sphere(1, 16), flipped(make_sphere(0.98, 16)))},
      {"box", merged(box, flipped(make_box({0.99, 0.99, 0.99}, 4)))},
      {"plate", make_box({1, 1, 0.005}, 12)},
      {"turned plate", [] {
         Mesh plate = make_box({1, 1, 0.005}, 12);
         Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
         transform(plate, turn, Vec3::Ones(), {0.1, 0.2, 0.3});
         return plate;
       }()}};
  int refused = 0;
  for (const auto& [shape, mesh] : shells) {
    scratch.write("shell.obj", obj_text(mesh));
    for (const auto& [name, arrangement] : arrangements)
      for (double spacing : {0.06, 0.3, 1.0, 3.0}) {
        SCOPED_TRACE(shape + ", " + name + ", " + std::to_string(spacing));
        try {
          Sampling sampling = sample_interior(mesh, {0, spacing, arrangement});
          EXPECT_GE(sampling.points.size(), 4u);
          continue;
        } catch (const std::runtime_error& error) {
          ++refused;
          const std::string message = error.what();
          const auto at = message.find("use at most ");
          ASSERT_NE(at, message.npos) << message;
          EXPECT_THAT(message, HasSubstr("spacing: "));
          // What it says suffices does suffice.
          const double needed = std::stod(message.substr(at + 12));
          EXPECT_LE(needed, spacing);
          EXPECT_GE(sample_interior(mesh, {0, needed, arrangement}).points.size(), 4u) << message;
        }
        std::ostringstream body;
        body << "sampling = \"" << name << "\"\nspacing = " << spacing;
        expect_run_refused(scratch, mesh_scene("shell.obj", body.str()),
                           {"scene.toml:8: body: spacing: ", "expected at least 4", "use at most "});
      }
  }
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace deforma
