#include <cstring>

#include "assets/import.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Property;

void expect_refused(const std::filesystem::path& file, const std::string& message) {
  EXPECT_THAT([&] { import_mesh(file); },
              testing::Throws<std::runtime_error>(
                  Property(&std::exception::what, AllOf(HasSubstr(file.string()), HasSubstr(message)))))
      << file;
}

const std::string ply_header =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string ply_points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string ply_faces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

std::string binary_stl(std::uint32_t promised, const std::vector<std::array<float, 9>>& triangles) {
  std::string stl(80, ' ');
  auto append = [&stl](const void* data, std::size_t size) {
    stl.append(static_cast<const char*>(data), size);
  };
  append(&promised, 4);
  for (const auto& t : triangles) {
    float normal[3] = {0, 0, 1};
    std::uint16_t nothing = 0;
    append(normal, 12);
    append(t.data(), 36);
    append(&nothing, 2);
  }
  return stl;
}

TEST(ImportRefuses, MissingFilesFoldersAndEmptyFiles) {
  TemporaryFolder folder;
  expect_refused(folder / "nothing.obj", "there is no such file");
  expect_refused(folder / "", "expected a mesh file, found a folder");
  expect_refused(folder.write("empty.obj", ""), "the file is empty");
}

TEST(ImportRefuses, FilesThatAreNoMesh) {
  TemporaryFolder folder;
  std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\6\0\0\0\x1f\x15\xc4\x89", 33);
  for (const char* name : {"picture.obj", "picture.ply", "picture.stl", "picture.off", "picture.dae",
                           "picture.glb", "picture.gltf", "picture.fbx", "picture.png", "picture"})
    expect_refused(folder.write(name, png), "");
  for (const char* name : {"letter.obj", "letter.ply", "letter.stl", "letter.off", "letter.dae", "letter.glb",
                           "letter.gltf", "letter.fbx", "letter.txt", "letter"})
    expect_refused(folder.write(name, "Dear reader,\nthis is a letter and no mesh.\n"), "");
}

TEST(ImportRefuses, TruncatedFiles) {
  TemporaryFolder folder;
  expect_refused(folder.write("cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"), "");
  expect_refused(folder.write("header.ply", ply_header.substr(0, 90)), "cut off in its header");
  expect_refused(folder.write("points.ply", ply_header + ply_points.substr(0, 12)),
                 "4 of element 'vertex' announced, 2 found");
  expect_refused(folder.write("faces.ply", ply_header + ply_points), "0 found");
  expect_refused(folder.write("faces.off", "OFF\n4 4 6\n" + ply_points), "4 faces announced, 0 found");
  expect_refused(folder.write("cut.stl", binary_stl(4, {{0, 0, 0, 1, 0, 0, 0, 1, 0}})), "");
  expect_refused(folder.write("cut.ply", ply_header + ply_points + ply_faces.substr(0, 20)),
                 "4 of element 'face' announced, 2 found");
  expect_refused(folder.write("cut.off", "OFF\n4 4 6\n" + ply_points + ply_faces.substr(0, 16)),
                 "4 faces announced, 2 found");
  expect_refused(
      folder.write("cut.stl",
                   "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                   "endloop\nendfacet\n"),
      "no endsolid");
  expect_refused(folder.write("cut.dae", "<?xml version=\"1.0\"?>\n<COLLADA><library_geometries><geom"), "");
  expect_refused(folder.write("cut.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": [{"), "");
  expect_refused(folder.write("cut.glb", std::string("glTF\2\0\0\0\xff\0\0\0", 12)), "");
}

TEST(ImportRefuses, VerticesThatAreNotFinite) {
  TemporaryFolder folder;
  for (const char* bad : {"nan", "inf", "-inf"}) {
    expect_refused(folder.write("bad.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 ") + bad + " 0\nf 1 2 3\n"),
                   "not finite");
    expect_refused(folder.write("bad.ply", ply_header + "0 0 0\n1 0 0\n0 1 0\n0 0 " + bad + "\n" + ply_faces),
                   "not finite");
  }
  float nan = std::numeric_limits<float>::quiet_NaN();
  expect_refused(folder.write("bad.stl", binary_stl(1, {{0, 0, nan, 1, 0, 0, 0, 1, 0}})), "not finite");
}

TEST(ImportRefuses, IndicesOutOfRange) {
  TemporaryFolder folder;
  expect_refused(folder.write("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "");
  expect_refused(folder.write("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"), "");
  expect_refused(folder.write("before.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 -1 -2\n"), "");
  expect_refused(folder.write("far.ply", ply_header + ply_points + "3 0 2 1\n3 0 1 3\n3 1 2 9\n3 0 3 2\n"),
                 "");
  expect_refused(
      folder.write("before.ply", ply_header + ply_points + "3 0 2 1\n3 0 1 3\n3 1 2 -1\n3 0 3 2\n"), "");
  expect_refused(
      folder.write("far.off", "OFF\n4 4 6\n" + ply_points + "3 0 2 1\n3 0 1 3\n3 1 2 7\n3 0 3 2\n"),
      "face 2 names vertex 7, but there are 4");
}

TEST(ImportRefuses, PointsLinesAndFlatFacesAlone) {
  TemporaryFolder folder;
  expect_refused(folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "");
  expect_refused(folder.write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n"), "points and lines");
  expect_refused(folder.write("needle.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "without area");
  expect_refused(folder.write("dot.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"), "without area");
}

}  // namespace
}  // namespace deforma
