#pragma once

#include <vector>

#include "render/gl.hpp"
#include "render/renderer.hpp"
#include "render/scene_fit.hpp"

namespace deforma {

/// A surface in the driver's memory.
struct UploadedMesh {
  gl::VertexArray array;
  gl::Buffer vertices;  ///< position and normal, 6 floats
  gl::Buffer values;    ///< places in the colour map, when it is drawn by them
  gl::Buffer indices;
  GLsizei corners = 0;
  gl::VertexArray edge_array;
  gl::Buffer edges;       ///< two indices each
  GLsizei edge_ends = 0;  ///< translucent meshes only: where just one triangle ends
  Look look;
  bool by_value = false;
  double distance = 0.0;    ///< from the eye to its middle [m]
  bool inside_out = false;  ///< its triangles face its middle; found for translucent meshes only

  void draw() const;
  void draw_edges() const;
};

/// Spheres in the driver's memory; one quad each.
struct UploadedSpheres {
  gl::VertexArray array;
  gl::Buffer centers;  ///< 3 floats
  gl::Buffer values;   ///< as of a mesh
  GLsizei count = 0;
  float radius = 0.0f;  ///< [m]
  Look look;
  bool by_value = false;

  void draw() const;
};

/// The frame's bodies, uploaded in single precision relative to the camera's target: a body far from the
/// origin loses nothing. Buffers are kept from frame to frame.
class Geometry {
 public:
  /// @throws std::invalid_argument naming the mesh and what is wrong with it.
  SceneBounds upload(const FrameContent& frame);

  const std::vector<UploadedMesh>& meshes() const { return meshes_; }
  const std::vector<UploadedSpheres>& spheres() const { return spheres_; }

 private:
  Box upload_mesh(const DrawnMesh& drawn, UploadedMesh& mesh, const FrameContent& frame, std::size_t number);
  Box upload_spheres(const DrawnSpheres& drawn, UploadedSpheres& spheres, const FrameContent& frame,
                     std::size_t number);

  std::vector<UploadedMesh> meshes_;
  std::vector<UploadedSpheres> spheres_;
  std::vector<float> staging_;
};

}  // namespace deforma
