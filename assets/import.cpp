#include "assets/import.hpp"

#include <assimp/config.h>
#include <assimp/scene.h>
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <cmath>
#include <span>
#include <stdexcept>

#include "assets/complete.hpp"
#include "assets/triangulate.hpp"
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

/// Adds up the meshes of a scene's nodes; a mesh that two nodes show is there twice.
class Merger {
 public:
  explicit Merger(const aiScene& scene) : scene_(scene) {
    add(*scene.mRootNode, Eigen::Affine3d::Identity());
  }

  Imported merged;
  std::size_t thin = 0;  ///< faces that are points or lines

 private:
  void add(const aiNode& node, const Eigen::Affine3d& above) {
    Eigen::Affine3d own = Eigen::Affine3d::Identity();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) own(row, column) = node.mTransformation[row][column];
    Eigen::Affine3d pose = above * own;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) add(*scene_.mMeshes[node.mMeshes[m]], pose);
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(*node.mChildren[c], pose);
  }

  void add(const aiMesh& mesh, const Eigen::Affine3d& pose) {
    bool mirrored = pose.linear().determinant() < 0.0;
    auto first = static_cast<std::uint32_t>(merged.mesh.points.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
      merged.mesh.points.push_back(
          pose * Eigen::Vector3d(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z));
    std::vector<Eigen::Vector3d> corners;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      std::span<const unsigned> face(mesh.mFaces[f].mIndices, mesh.mFaces[f].mNumIndices);
      thin += face.size() < 3;
      merged.polygons += face.size() > 3;
      corners.clear();
      for (unsigned i : face) corners.push_back(merged.mesh.points[first + i]);
      for (auto [a, b, c] : triangulate(corners)) {
        if (mirrored) std::swap(b, c);
        merged.mesh.triangles.push_back({first + face[a], first + face[b], first + face[c]});
      }
    }
    ++merged.meshes;
  }

  const aiScene& scene_;
};

}  // namespace

Imported import_mesh(const fs::path& file) {
  check_file(file);
  check_complete(file);
  Assimp::Importer importer;
  // Axes stay as the file has them; without this a z-up COLLADA file would be laid on its back.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (!scene) refuse(file, fmt::format("no mesh could be read from it ({})", importer.GetErrorString()));
  if (scene->mNumMeshes == 0 || !scene->mRootNode) refuse(file, "there is no mesh in it");
  check_scene(file, *scene);
  Merger merger(*scene);
  Imported imported = std::move(merger.merged);
  if (imported.mesh.triangles.empty())
    refuse(file, merger.thin > 0 ? "there are only points and lines in it, expected triangles"
                                 : "there is no triangle in it");

  WeldReport report = weld(imported.mesh);
  imported.welded_points = report.welded_points;
  imported.dropped_triangles = report.dropped_triangles;
  if (imported.mesh.triangles.empty())
    refuse(file, fmt::format("all of its {} triangles are without area", report.dropped_triangles));
  if (merger.thin > 0)
    imported.warnings.push_back(fmt::format("{} points and lines were left out", merger.thin));
  if (report.dropped_triangles > 0)
    imported.warnings.push_back(
        fmt::format("{} triangles without area were left out", report.dropped_triangles));
  return imported;
}

}  // namespace deforma
