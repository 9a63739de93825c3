#include "assets/import.hpp"

#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>

#include "assets/shapes.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;

// A unit cube from (0,0,0) to (1,1,1), every face a quad: 8 points, 12 triangles, volume 1.
const std::string cube_points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
const std::string cube_obj =
    cube_points + "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

void expect_cube(const Imported& imported, double side = 1.0) {
  MeshFacts facts = inspect(imported.mesh);
  EXPECT_EQ(imported.mesh.points.size(), 8u);
  EXPECT_EQ(imported.mesh.triangles.size(), 12u);
  EXPECT_EQ(facts.boundary_edges, 0u);
  EXPECT_EQ(facts.non_manifold_edges, 0u);
  EXPECT_EQ(facts.components, 1u);
  EXPECT_NEAR(facts.volume, side * side * side, 1e-5 * side * side * side);
}

/// The cube written by assimp in one of its formats.
Imported through(const std::string& format, const std::string& extension) {
  TemporaryFolder folder;
  auto source = folder.write("cube.obj", cube_obj);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(source.string(), 0);
  auto file = folder / ("cube." + extension);
  Assimp::Exporter exporter;
  EXPECT_EQ(exporter.Export(scene, format, file.string()), aiReturn_SUCCESS) << exporter.GetErrorString();
  return import_mesh(file);
}

TEST(Import, ObjWithPolygons) {
  TemporaryFolder folder;
  Imported imported = import_mesh(folder.write("cube.obj", cube_obj));
  expect_cube(imported);
  EXPECT_EQ(imported.meshes, 1u);
  EXPECT_EQ(imported.polygons, 6u);
  EXPECT_EQ(imported.dropped_triangles, 0u);
  EXPECT_THAT(imported.warnings, testing::IsEmpty());
}

TEST(Import, ObjWithNegativeIndices) {
  TemporaryFolder folder;
  expect_cube(import_mesh(folder.write(
      "cube.obj", cube_points + "f -5 -6 -7 -8\nf -4 -3 -2 -1\nf -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\n"
                                "f -5 -8 -4 -1\n")));
}

TEST(Import, ConcavePolygonsKeepTheirArea) {
  TemporaryFolder folder;
  // An L of area 3, six corners, as a prism of height 1.
  std::string obj;
  const double corner[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (int z : {0, 1})
    for (const auto& c : corner)
      obj += "v " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(z) + "\n";
  obj += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
  for (int i = 0; i < 6; ++i) {
    int next = (i + 1) % 6;
    obj += "f " + std::to_string(i + 1) + " " + std::to_string(next + 1) + " " + std::to_string(next + 7) +
           " " + std::to_string(i + 7) + "\n";
  }
  Imported imported = import_mesh(folder.write("corner.obj", obj));
  MeshFacts facts = inspect(imported.mesh);
  EXPECT_EQ(imported.polygons, 8u);
  EXPECT_EQ(facts.boundary_edges, 0u);
  EXPECT_NEAR(facts.volume, 3.0, 1e-6);
  EXPECT_NEAR(facts.area, 14.0, 1e-6);
}

TEST(Import, SeamsAreWelded) {
  TemporaryFolder folder;
  std::string obj = cube_points + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  for (const char* face : {"4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"}) {
    std::istringstream corners(face);
    std::string line = "f", c;
    for (int i = 1; corners >> c; ++i) line += " " + c + "/" + std::to_string(i);
    obj += line + "\n";
  }
  Imported imported = import_mesh(folder.write("seams.obj", obj));
  expect_cube(imported);
  EXPECT_GT(imported.welded_points, 0u);
}

TEST(Import, DegenerateTrianglesAreDroppedAndCounted) {
  TemporaryFolder folder;
  Imported imported =
      import_mesh(folder.write("cube.obj", cube_obj + "v 0.5 0 0\nf 1 1 2\nf 1 2 9\nv 0 0 0\nf 1 10 3\n"));
  expect_cube(imported);
  EXPECT_EQ(imported.dropped_triangles, 3u);
  EXPECT_THAT(imported.warnings, testing::Contains(testing::HasSubstr("3 triangles without area")));
}

TEST(Import, LinesBesideTrianglesAreLeftOutWithAWarning) {
  TemporaryFolder folder;
  Imported imported = import_mesh(folder.write("cube.obj", cube_obj + "l 1 7\n"));
  expect_cube(imported);
  EXPECT_THAT(imported.warnings, testing::Contains(testing::HasSubstr("points and lines were left out")));
}

TEST(Import, PlyStlAndOffByHand) {
  TemporaryFolder folder;
  const std::string corners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
  const std::string faces = "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
  Imported ply =
      import_mesh(folder.write("cube.ply",
                               "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float "
                               "y\nproperty float z\nelement face 6\nproperty list uchar int "
                               "vertex_indices\nend_header\n" +
                                   corners + faces));
  expect_cube(ply);
  EXPECT_EQ(ply.polygons, 6u);
  expect_cube(import_mesh(folder.write("cube.off", "OFF\n8 6 12\n" + corners + faces)));

  std::string stl = "solid cube\n";
  Mesh box = make_box({1, 1, 1}, 1);
  for (const auto& t : box.triangles) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (std::uint32_t i : t) {
      const Vector3d& p = box.points[i];
      stl += "vertex " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) +
             "\n";
    }
    stl += "endloop\nendfacet\n";
  }
  Imported imported = import_mesh(folder.write("cube.stl", stl + "endsolid cube\n"));
  expect_cube(imported);
  EXPECT_EQ(imported.welded_points, 28u);
}

TEST(Import, EveryFormatThatAssimpWrites) {
  for (auto [format, extension] : {std::pair{"gltf2", "gltf"},
                                   {"glb2", "glb"},
                                   {"collada", "dae"},
                                   {"plyb", "ply"},
                                   {"stlb", "stl"},
                                   {"obj", "obj"},

                                   {"fbxa", "fbx"},
                                   {"3ds", "3ds"},
                                   {"x", "x"}}) {
    SCOPED_TRACE(format);
    expect_cube(through(format, extension));
  }
}

TEST(Import, EveryNodeWithItsPose) {
  TemporaryFolder folder;
  // One mesh shown by two nodes: one moved, one mirrored below a parent that doubles lengths.
  Assimp::Importer importer;
  importer.ReadFile(folder.write("cube.obj", cube_obj).string(), 0);
  aiScene* scene = importer.GetOrphanedScene();
  delete scene->mRootNode;
  auto node = [](const char* name, const aiMatrix4x4& pose, bool has_mesh) {
    auto* made = new aiNode(name);
    made->mTransformation = pose;
    if (has_mesh) {
      made->mNumMeshes = 1;
      made->mMeshes = new unsigned[1]{0};
    }
    return made;
  };
  auto diagonal = [](float x, float y, float z, float tx) {
    return aiMatrix4x4(x, 0, 0, tx, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1);
  };
  scene->mRootNode = node("root", diagonal(2, 2, 2, 0), false);
  aiNode* children[] = {node("moved", diagonal(1, 1, 1, 5), true),
                        node("mirrored", diagonal(-1, 1, 1, 0), true)};
  scene->mRootNode->addChildren(2, children);
  auto file = folder / "two.dae";
  Assimp::Exporter exporter;
  ASSERT_EQ(exporter.Export(scene, "collada", file.string()), aiReturn_SUCCESS);
  delete scene;

  Imported imported = import_mesh(file);
  MeshFacts facts = inspect(imported.mesh);
  EXPECT_EQ(imported.meshes, 2u);
  EXPECT_EQ(facts.components, 2u);
  EXPECT_NEAR(facts.volume, 16.0, 1e-4) << "a mirrored part must still face outwards";
  EXPECT_NEAR((facts.min - Vector3d(-2, 0, 0)).norm(), 0.0, 1e-5);
  EXPECT_NEAR((facts.max - Vector3d(12, 2, 2)).norm(), 0.0, 1e-5);
}

TEST(Import, ColladaStaysUprightInItsOwnUnit) {
  TemporaryFolder folder;
  auto file = folder.write("upright.dae", R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 0 100 0 0 0 300</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  MeshFacts facts = inspect(import_mesh(file).mesh);
  EXPECT_NEAR((facts.max - Vector3d(1, 1, 3)).norm(), 0.0, 1e-5);
  EXPECT_NEAR(facts.volume, 0.5, 1e-5);
}

TEST(Import, GivesTheSameMeshEveryTime) {
  TemporaryFolder folder;
  auto file = folder.write("cube.obj", cube_obj);
  Imported a = import_mesh(file), b = import_mesh(file);
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
}

}  // namespace
}  // namespace deforma
