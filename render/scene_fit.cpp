#include "render/scene_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace deforma {
namespace {

Eigen::Vector3d corner_of(const Box& box, int corner) {
  return {corner & 1 ? box.max.x() : box.min.x(), corner & 2 ? box.max.y() : box.min.y(),
          corner & 4 ? box.max.z() : box.min.z()};
}

}  // namespace

void Box::add(const Eigen::Vector3d& point, double margin) {
  min = min.cwiseMin((point.array() - margin).matrix());
  max = max.cwiseMax((point.array() + margin).matrix());
}

void Box::add(const Box& other) {
  min = min.cwiseMin(other.min);
  max = max.cwiseMax(other.max);
}

PixelBox bounds_in_picture(const Box& box, const Eigen::Matrix4f& clip, int width, int height) {
  if (box.empty()) return {};
  Eigen::Array2d low = Eigen::Array2d::Constant(1.0), high = Eigen::Array2d::Constant(-1.0);
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector4d point = clip.cast<double>() * corner_of(box, corner).homogeneous();
    if (point.w() <= 0.0) return {0, 0, width, height};
    low = low.min(point.head<2>().array() / point.w());
    high = high.max(point.head<2>().array() / point.w());
  }
  const Eigen::Array2d size(width, height);
  const Eigen::Array2d first = (0.5 * (low.max(-1.0) + 1.0) * size - 2.0).floor().max(0.0);
  const Eigen::Array2d last = (0.5 * (high.min(1.0) + 1.0) * size + 2.0).ceil().min(size);
  if ((first >= last).any()) return {};
  return {static_cast<int>(first.x()), static_cast<int>(first.y()), static_cast<int>(last.x() - first.x()),
          static_cast<int>(last.y() - first.y())};
}

DepthRange fit_depth(const SceneBounds& bounds, const Eigen::Vector3d& eye, double ground_radius) {
  const double away = eye.norm();
  const Eigen::Vector3d back = eye / away;
  double nearest = away, farthest = away;
  if (!bounds.content.empty()) {
    nearest = farthest = (eye - bounds.content.center()).dot(back);
    for (int corner = 0; corner < 8; ++corner) {
      const double depth = (eye - corner_of(bounds.content, corner)).dot(back);
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  }
  if (bounds.has_ground) {
    const Eigen::Vector3d center = bounds.content.empty() ? Eigen::Vector3d::Zero() : bounds.content.center();
    farthest = std::max(farthest, (eye - center).dot(back) + ground_radius);
    // The ground may come up to the feet of the camera; what is visible of it is no nearer than a part of its
    // height.
    nearest = std::min(nearest, 0.3 * std::abs(eye.z() - bounds.ground));
  }
  DepthRange range;
  range.far_plane = 1.01 * std::max(farthest, 1e-3 * away);
  // Single precision depth keeps apart what is 1e-7 of the ratio apart, so a ratio of 5000 costs nothing
  // visible.
  range.near_plane = std::clamp(0.95 * nearest, range.far_plane / 5000.0, 0.5 * range.far_plane);
  return range;
}

DepthRange fit_parallel_depth(const SceneBounds& bounds, const Eigen::Vector3d& eye, double ground_radius) {
  const Eigen::Vector3d back = eye.normalized();
  const Eigen::Vector3d center = bounds.content.empty() ? Eigen::Vector3d::Zero() : bounds.content.center();
  const double radius = std::max(bounds.content.empty() ? eye.norm() : bounds.content.radius(),
                                 bounds.has_ground ? 1.5 * ground_radius : 0.0);
  // The ground's middle may lie far below the content's.
  const double reach = 1.01 * radius + (bounds.has_ground ? std::abs(center.z() - bounds.ground) : 0.0);
  const double middle = (eye - center).dot(back);
  return {middle - reach, middle + reach};
}

ShadowFit fit_shadow(const Box& casters, const Eigen::Vector3d& to_light, double margin) {
  const Eigen::Vector3d z = to_light.normalized();
  const Eigen::Vector3d helper = std::abs(z.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d x = helper.cross(z).normalized();
  const Eigen::Vector3d y = z.cross(x);
  Eigen::Matrix3d rotation;
  rotation.row(0) = x;
  rotation.row(1) = y;
  rotation.row(2) = -z;  // depth grows away from the light

  Box box;
  for (int corner = 0; corner < 8; ++corner) box.add(rotation * corner_of(casters, corner));
  ShadowFit fit;
  fit.width = std::max(box.max.x() - box.min.x(), box.max.y() - box.min.y()) + 2.0 * margin;
  fit.depth = box.max.z() - box.min.z() + 2.0 * margin;
  const Eigen::Vector3d scale(1.0 / fit.width, 1.0 / fit.width, 1.0 / fit.depth);
  fit.matrix.setIdentity();
  fit.matrix.topLeftCorner<3, 3>() = scale.asDiagonal() * rotation;
  fit.matrix.topRightCorner<3, 1>() = Eigen::Vector3d::Constant(0.5) - scale.cwiseProduct(box.center());
  return fit;
}

GroundRegion fit_ground(const SceneBounds& bounds, const Eigen::Vector3d& to_light, double reach) {
  Box footprint;
  // A light near the horizon would throw shadows without end; beyond a few lengths they are too faint to
  // keep.
  const double slope = std::min(to_light.head<2>().norm() / std::max(to_light.z(), 1e-3), 3.0);
  const Eigen::Vector2d sideways = to_light.head<2>().norm() > 0.0
                                       ? Eigen::Vector2d(-slope * to_light.head<2>().normalized())
                                       : Eigen::Vector2d(Eigen::Vector2d::Zero());
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d point = corner_of(bounds.casters, corner);
    footprint.add(point);
    const Eigen::Vector2d shadow = point.head<2>() + sideways * std::max(point.z() - bounds.ground, 0.0);
    footprint.add(Eigen::Vector3d(shadow.x(), shadow.y(), point.z()));
  }
  GroundRegion region;
  region.min = (footprint.min.head<2>().array() - reach).matrix();
  region.size = (footprint.max.head<2>().array() + reach).matrix() - region.min;
  return region;
}

}  // namespace deforma
