#include "assets/import.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <cmath>
#include <stdexcept>

#include "assets/weld.hpp"

namespace deforma {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, std::string_view what) {
  throw std::runtime_error(fmt::format("{}: {}", file.string(), what));
}

void check_file(const fs::path& file) {
  std::error_code error;
  fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) refuse(file, "there is no such file");
  if (fs::is_directory(status)) refuse(file, "expected a mesh file, found a folder");
  if (!fs::is_regular_file(status))
    refuse(file, "expected a mesh file, found something that is no regular file");
  std::uintmax_t size = fs::file_size(file, error);
  if (error) refuse(file, error.message());
  if (size == 0) refuse(file, "the file is empty");
}

/// Looks at what the reader made of the file before anything walks over it by index.
void check_scene(const fs::path& file, const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        refuse(file, fmt::format("vertex {} of mesh {} is not finite: [{}, {}, {}]", v, m, p.x, p.y, p.z));
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
      for (unsigned c = 0; c < mesh.mFaces[f].mNumIndices; ++c)
        if (mesh.mFaces[f].mIndices[c] >= mesh.mNumVertices)
          refuse(file, fmt::format("face {} of mesh {} names vertex {}, but there are {}", f, m,
                                   mesh.mFaces[f].mIndices[c], mesh.mNumVertices));
  }
}

/// Faces of each kind in the nodes of a scene; a mesh that two nodes show counts twice.
struct FaceCount {
  std::size_t meshes = 0;
  std::size_t polygons = 0;  ///< more than three corners
  std::size_t thin = 0;      ///< points and lines

  void add(const aiScene& scene, const aiNode& node) {
    meshes += node.mNumMeshes;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        polygons += mesh.mFaces[f].mNumIndices > 3;
        thin += mesh.mFaces[f].mNumIndices < 3;
      }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(scene, *node.mChildren[c]);
  }
};

void append_node(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& above, Mesh& out) {
  Eigen::Affine3d pose = above;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      double sum = column == 3 ? above(row, 3) : 0.0;
      for (int k = 0; k < 3; ++k) sum += above(row, k) * node.mTransformation[k][column];
      pose(row, column) = sum;
    }
  bool mirrored = pose.linear().determinant() < 0.0;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    auto first = static_cast<std::uint32_t>(out.points.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
      out.points.push_back(pose *
                           Eigen::Vector3d(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z));
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<std::uint32_t, 3> t{first + face.mIndices[0], first + face.mIndices[1],
                                     first + face.mIndices[2]};
      if (mirrored) std::swap(t[1], t[2]);
      out.triangles.push_back(t);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) append_node(scene, *node.mChildren[c], pose, out);
}

}  // namespace

Imported import_mesh(const fs::path& file) {
  check_file(file);
  Assimp::Importer importer;
  // Axes stay as the file has them; without this a z-up COLLADA file would be laid on its back.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (!scene) refuse(file, fmt::format("no mesh could be read from it ({})", importer.GetErrorString()));
  if (scene->mNumMeshes == 0 || !scene->mRootNode) refuse(file, "there is no mesh in it");
  check_scene(file, *scene);
  FaceCount count;
  count.add(*scene, *scene->mRootNode);
  if (count.polygons > 0) {
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    if (!scene)
      refuse(file, fmt::format("its polygons could not be triangulated ({})", importer.GetErrorString()));
    check_scene(file, *scene);
  }

  Imported imported;
  imported.meshes = count.meshes;
  imported.polygons = count.polygons;
  append_node(*scene, *scene->mRootNode, Eigen::Affine3d::Identity(), imported.mesh);
  if (imported.mesh.triangles.empty())
    refuse(file, count.thin > 0 ? "there are only points and lines in it, expected triangles"
                                : "there is no triangle in it");

  WeldReport report = weld(imported.mesh);
  imported.welded_points = report.welded_points;
  imported.dropped_triangles = report.dropped_triangles;
  if (imported.mesh.triangles.empty())
    refuse(file, fmt::format("all of its {} triangles are without area", report.dropped_triangles));
  if (count.thin > 0)
    imported.warnings.push_back(fmt::format("{} points and lines were left out", count.thin));
  if (report.dropped_triangles > 0)
    imported.warnings.push_back(
        fmt::format("{} triangles without area were left out", report.dropped_triangles));
  return imported;
}

}  // namespace deforma
