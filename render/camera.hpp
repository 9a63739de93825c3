#pragma once

#include <Eigen/Core>

namespace deforma {

/// A pinhole camera, or one whose rays are parallel.
struct Camera {
  Eigen::Vector3d eye = {3.0, -4.0, 2.0};    ///< [m]
  Eigen::Vector3d target = {0.0, 0.0, 0.0};  ///< [m]
  Eigen::Vector3d up = {0.0, 0.0, 1.0};
  double field_of_view = 35.0;  ///< vertical [degrees]
  double height = 0.0;          ///< of what a parallel (orthographic) projection shows [m]; 0: perspective

  bool is_parallel() const { return height > 0.0; }
};

/// Looks at a box from `direction` (from the target to the eye) so that all of it is in the picture.
/// @param aspect width over height
Camera frame_box(const Eigen::Vector3d& min, const Eigen::Vector3d& max, double aspect,
                 const Eigen::Vector3d& direction = {0.55, -1.0, 0.42}, double field_of_view = 30.0);

/// Height of the parallel projection that shows a box from where the camera stands [m].
double frame_height(const Camera& camera, const Eigen::Vector3d& min, const Eigen::Vector3d& max,
                    double aspect);

/// World to eye space, and eye to clip space with depth from `near_plane` to `far_plane` [m].
Eigen::Matrix4d view_matrix(const Camera& camera);
Eigen::Matrix4d projection_matrix(const Camera& camera, double aspect, double near_plane, double far_plane);

}  // namespace deforma
