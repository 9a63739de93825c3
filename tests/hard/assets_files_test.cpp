#include <cstring>
#include <limits>

#include "tests/hard/refusal.hpp"

namespace deforma {
namespace {

const std::string ply_header =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string ply_points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string ply_faces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const std::string obj_points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const std::string obj_faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

/// A binary STL file of one triangle at the given height that promises `promised` of them.
std::string binary_stl(std::uint32_t promised, float z) {
  std::string stl(80, ' ');
  auto append = [&stl](const void* data, std::size_t size) {
    stl.append(static_cast<const char*>(data), size);
  };
  append(&promised, 4);
  const float numbers[12] = {0, 0, 1, 0, 0, z, 1, 0, z, 0, 1, z};
  append(numbers, sizeof numbers);
  stl.append(2, '\0');
  return stl;
}

struct BadFile {
  std::string name, text, message;
};

/// Each must be refused where the scene names it, with the file's name and what is wrong with it.
void expect_all_refused(const std::vector<BadFile>& files) {
  Scratch scratch;
  for (const BadFile& bad : files) {
    scratch.write(bad.name, bad.text);
    expect_run_refused(scratch, mesh_scene(bad.name, "particles = 50"),
                       {"scene.toml:9: body.mesh: ", (scratch / bad.name).string(), bad.message});
    std::filesystem::remove(scratch / bad.name);
  }
}

TEST(HardCase, Row27VerticesThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  std::vector<BadFile> files = {{"bad.stl", binary_stl(1, nan), "not finite"},
                                {"bad.stl", binary_stl(1, -inf), "not finite"}};
  for (std::string bad : {"nan", "inf", "-inf"}) {
    files.push_back({"bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 " + bad + "\n" + obj_faces, "not finite"});
    files.push_back(
        {"bad.ply", ply_header + "0 0 0\n1 0 0\n0 1 0\n0 0 " + bad + "\n" + ply_faces, "not finite"});
    files.push_back(
        {"bad.off", "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 " + bad + "\n" + ply_faces, "not finite"});
  }
  expect_all_refused(files);
}

TEST(HardCase, Row27IndicesOutOfRange) {
  expect_all_refused({{"far.obj", obj_points + "f 1 2 5\n", "no mesh could be read"},
                      {"zero.obj", obj_points + "f 0 1 2\n", "no mesh could be read"},
                      {"before.obj", obj_points + "f -5 -1 -2\n", "no mesh could be read"},
                      {"far.ply", ply_header + ply_points + "3 0 2 1\n3 0 1 3\n3 1 2 9\n3 0 3 2\n", ""},
                      {"before.ply", ply_header + ply_points + "3 0 2 1\n3 0 1 3\n3 1 2 -1\n3 0 3 2\n", ""},
                      {"far.off", "OFF\n4 4 6\n" + ply_points + "3 0 2 1\n3 0 1 3\n3 1 2 7\n3 0 3 2\n",
                       "face 2 names vertex 7, but there are 4"}});
}

TEST(HardCase, Row27EmptyFilesAndFilesThatAreNoMesh) {
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\6\0\0\0\x1f\x15\xc4\x89", 33);
  std::vector<BadFile> files;
  for (std::string ending : {"obj", "ply", "stl", "off", "dae", "glb", "gltf", "fbx", "txt"}) {
    files.push_back({"empty." + ending, "", "the file is empty"});
    files.push_back({"picture." + ending, png, ""});
    files.push_back({"letter." + ending, "Dear reader,\nthis is a letter and no mesh.\n", ""});
  }
  expect_all_refused(files);
}

TEST(HardCase, Row27TruncatedFiles) {
  expect_all_refused(
      {{"cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n", "no mesh could be read"},
       {"cut.ply", ply_header.substr(0, 90), "cut off in its header"},
       {"cut.ply", ply_header + ply_points.substr(0, 12), "4 of element 'vertex' announced, 2 found"},
       {"cut.ply", ply_header + ply_points + ply_faces.substr(0, 20),
        "4 of element 'face' announced, 2 found"},
       {"cut.off", "OFF\n4 4 6\n" + ply_points + ply_faces.substr(0, 16), "4 faces announced, 2 found"},
       {"cut.stl", binary_stl(4, 0), ""},
       {"cut.stl",
        "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\n",
        "no endsolid"},
       {"cut.dae", "<?xml version=\"1.0\"?>\n<COLLADA><library_geometries><geom", ""},
       {"cut.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": [{", ""},
       {"cut.glb", std::string("glTF\2\0\0\0\xff\0\0\0", 12), ""}});
}

TEST(HardCase, Row27NoFileOrAFolder) {
  Scratch scratch;
  std::filesystem::create_directories(scratch / "meshes.obj");
  scratch.write("duck.obj", obj_points + obj_faces);
  expect_run_refused(scratch, mesh_scene("dukc.obj", "particles = 50"),
                     {"scene.toml:9: body.mesh: no such file 'dukc.obj'", "did you mean 'duck.obj'?"});
  for (std::string folder : {".", "..", "meshes.obj", "/"})
    expect_run_refused(scratch, mesh_scene(folder, "particles = 50"),
                       {"scene.toml:9: body.mesh: '" + folder + "' is a folder; expected a mesh file"});
}

}  // namespace
}  // namespace deforma
