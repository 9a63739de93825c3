#pragma once

#include <Eigen/Core>

#include "render/camera.hpp"

namespace deforma {

/// A box that grows; empty until something is in it.
struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(1e300);
  Eigen::Vector3d max = Eigen::Vector3d::Constant(-1e300);

  bool empty() const { return min.x() > max.x(); }
  Eigen::Vector3d center() const { return 0.5 * (min + max); }
  double radius() const { return 0.5 * (max - min).norm(); }
  void add(const Eigen::Vector3d& point, double margin = 0.0);
  void add(const Box& other);
};

/// What is drawn, in metres relative to the camera's target.
struct SceneBounds {
  Box content;  ///< everything but the ground
  Box casters;  ///< what throws a shadow
  bool has_ground = false;
  double ground = 0.0;  ///< its height
};

/// Pixels, counted from the lower left.
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Where a box can be seen in a picture, a little widened; all of it when the box reaches behind the eye.
PixelBox bounds_in_picture(const Box& box, const Eigen::Matrix4f& clip, int width, int height);

/// Distances along the view between which all of the scene lies [m].
struct DepthRange {
  double near_plane = 0.1;
  double far_plane = 100.0;
};

/// @param eye relative to the target [m]
/// @param ground_radius that the ground reaches from the content's center [m]
DepthRange fit_depth(const SceneBounds& bounds, const Eigen::Vector3d& eye, double ground_radius);

/// The same for a parallel projection, whose near plane may lie behind the eye.
DepthRange fit_parallel_depth(const SceneBounds& bounds, const Eigen::Vector3d& eye, double ground_radius);

/// A parallel projection along the light that holds the casters tightly.
struct ShadowFit {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();  ///< to [0, 1]^3: across, across, away from the light
  double width = 1.0;                                    ///< of the square it covers [m]
  double depth = 1.0;                                    ///< along the light [m]
};

/// @param to_light unit
/// @param margin kept free around the casters for filtering [m]
ShadowFit fit_shadow(const Box& casters, const Eigen::Vector3d& to_light, double margin);

/// The part of the ground that shadow and occlusion are kept for: where casters stand and where their shadow
/// falls.
struct GroundRegion {
  Eigen::Vector2d min = Eigen::Vector2d::Zero();   ///< [m]
  Eigen::Vector2d size = Eigen::Vector2d::Ones();  ///< [m]
};

/// @param reach of the occlusion beyond the casters [m]
GroundRegion fit_ground(const SceneBounds& bounds, const Eigen::Vector3d& to_light, double reach);

}  // namespace deforma
