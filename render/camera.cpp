#include "render/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace deforma {
namespace {

double half_tangent(double degrees) {
  if (!(degrees > 0.0 && degrees < 180.0))
    throw std::invalid_argument("the camera's field of view is " + std::to_string(degrees) +
                                " degrees; allowed is more than 0 and less than 180");
  return std::tan(0.5 * degrees * std::numbers::pi / 180.0);
}

/// Columns: right, up, back (towards the eye). Another up is taken where the given one runs along the view.
Eigen::Matrix3d axes(const Eigen::Vector3d& back, const Eigen::Vector3d& up) {
  const Eigen::Vector3d z = back.normalized();
  Eigen::Vector3d x = up.cross(z);
  if (!(x.norm() > 1e-6 * up.norm())) x = Eigen::Vector3d::UnitY().cross(z);
  if (!(x.norm() > 1e-6)) x = Eigen::Vector3d::UnitX().cross(z);
  x.normalize();
  Eigen::Matrix3d basis;
  basis << x, z.cross(x), z;
  return basis;
}

}  // namespace

Camera frame_box(const Eigen::Vector3d& min, const Eigen::Vector3d& max, double aspect,
                 const Eigen::Vector3d& direction, double field_of_view) {
  if (!min.allFinite() || !max.allFinite() || (max - min).minCoeff() < 0.0)
    throw std::invalid_argument("the box to look at is empty or not finite");
  if (!(aspect > 0.0) || !std::isfinite(aspect))
    throw std::invalid_argument("the aspect of the picture must be positive, not " + std::to_string(aspect));
  if (!direction.allFinite() || direction.norm() == 0.0)
    throw std::invalid_argument("the direction to look from must be finite and not zero");
  const double tan_y = half_tangent(field_of_view);
  const double tan_x = tan_y * aspect;

  Camera camera;
  camera.field_of_view = field_of_view;
  const Eigen::Vector3d center = 0.5 * (min + max);
  const Eigen::Matrix3d basis = axes(direction, camera.up);

  // A corner (x, y, z) seen from (a, b, d) is in the picture when |x - a| <= tan_x (d - z), and so for y.
  // With l = max(x + tan_x z) and r = max(-x + tan_x z) the nearest eye is at a = (l - r) / 2, d = (l + r) /
  // (2 tan_x).
  double left = -1e300, right = -1e300, top = -1e300, bottom = -1e300, nearest = -1e300;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d point(corner & 1 ? max.x() : min.x(), corner & 2 ? max.y() : min.y(),
                                corner & 4 ? max.z() : min.z());
    const Eigen::Vector3d p = basis.transpose() * (point - center);
    left = std::max(left, p.x() + tan_x * p.z());
    right = std::max(right, -p.x() + tan_x * p.z());
    top = std::max(top, p.y() + tan_y * p.z());
    bottom = std::max(bottom, -p.y() + tan_y * p.z());
    nearest = std::max(nearest, p.z());
  }
  const double size = (max - min).norm() > 0.0 ? (max - min).norm() : 1.0;
  const double fit = std::max((left + right) / (2.0 * tan_x), (top + bottom) / (2.0 * tan_y));
  const double margin = 0.06 * size / tan_y;  // some air around it
  const double distance = std::max(fit + margin, nearest + 0.05 * size);
  camera.target = center + basis * Eigen::Vector3d(0.5 * (left - right), 0.5 * (top - bottom), 0.0);
  camera.eye = camera.target + distance * basis.col(2);
  return camera;
}

double frame_height(const Camera& camera, const Eigen::Vector3d& min, const Eigen::Vector3d& max,
                    double aspect) {
  const Eigen::Matrix4d view = view_matrix(camera);
  double half = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector4d point(corner & 1 ? max.x() : min.x(), corner & 2 ? max.y() : min.y(),
                                corner & 4 ? max.z() : min.z(), 1.0);
    const Eigen::Vector4d seen = view * point;
    half = std::max({half, std::abs(seen.y()), std::abs(seen.x()) / aspect});
  }
  return half > 0.0 ? 2.12 * half : 1.0;  // some air around it
}

Eigen::Matrix4d view_matrix(const Camera& camera) {
  const Eigen::Vector3d back = camera.eye - camera.target;
  if (!back.allFinite() || back.norm() == 0.0)
    throw std::invalid_argument("the camera's eye and target must be finite and apart from each other");
  if (!camera.up.allFinite() || camera.up.norm() == 0.0)
    throw std::invalid_argument("the camera's up must be finite and not zero");
  const Eigen::Matrix3d rotation = axes(back, camera.up).transpose();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = rotation;
  view.topRightCorner<3, 1>() = -(rotation * camera.eye);
  return view;
}

Eigen::Matrix4d projection_matrix(const Camera& camera, double aspect, double near_plane, double far_plane) {
  if (!(aspect > 0.0))
    throw std::invalid_argument("the aspect of the picture must be positive, not " + std::to_string(aspect));
  if (camera.is_parallel()) {
    Eigen::Matrix4d projection = Eigen::Matrix4d::Identity();
    projection(0, 0) = 2.0 / (camera.height * aspect);
    projection(1, 1) = 2.0 / camera.height;
    projection(2, 2) = -2.0 / (far_plane - near_plane);
    projection(2, 3) = (far_plane + near_plane) / (near_plane - far_plane);
    return projection;
  }
  const double tan_y = half_tangent(camera.field_of_view);
  if (!(near_plane > 0.0 && far_plane > near_plane))
    throw std::invalid_argument("the near plane must be positive and nearer than the far plane, not " +
                                std::to_string(near_plane) + " and " + std::to_string(far_plane));
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = 1.0 / (tan_y * aspect);
  projection(1, 1) = 1.0 / tan_y;
  projection(2, 2) = (far_plane + near_plane) / (near_plane - far_plane);
  projection(2, 3) = 2.0 * far_plane * near_plane / (near_plane - far_plane);
  projection(3, 2) = -1.0;
  return projection;
}

}  // namespace deforma
