#include "sim/obstacle_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "sim/rotation.hpp"

namespace deforma {
namespace {

double thickness_of(const ObstacleShape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape); box && !box->inside) return box->size.minCoeff();
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape); cylinder && !cylinder->inside)
    return std::min(2.0 * cylinder->radius, cylinder->height);
  if (const auto* sphere = std::get_if<SphereShape>(&shape); sphere && !sphere->inside)
    return 2.0 * sphere->radius;
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) {
    Vec3 low = mesh->points.front(), high = low;
    for (const Vec3& point : mesh->points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    return (high - low).minCoeff();
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

ObstacleMotion::ObstacleMotion(const Obstacle& obstacle)
    : field_(obstacle),
      position_(obstacle.position),
      rotation_(obstacle.rotation),
      friction_(obstacle.friction),
      thickness_(thickness_of(obstacle.shape)) {}

void ObstacleMotion::move_to(double time) {
  const Vec3 vector = rotation_.at(time);
  pose_ = {position_.at(time), rotation_matrix(vector)};
  velocity_ = position_.rate(time);
  spin_ = angular_velocity(vector, rotation_.rate(time));
}

void ObstacleMotion::find(const Vec3& point, std::vector<Touch>& touches, double reach) const {
  touches.clear();
  field_.find(pose_.rotation.transpose() * (point - pose_.position), touches, reach);
  for (Touch& touch : touches) touch.normal = pose_.rotation * touch.normal;
}

double ObstacleMotion::clearance(const Vec3& point) const {
  return field_.clearance(pose_.rotation.transpose() * (point - pose_.position));
}

Vec3 ObstacleMotion::velocity_at(const Vec3& point) const {
  return velocity_ + spin_.cross(point - pose_.position);
}

void ObstacleMotion::remember(const Vec3& center, double radius) {
  remembered_ = pose_;
  center_ = center;
  radius_ = radius;
}

double ObstacleMotion::moved(double growth) const {
  const double lever = (center_ - remembered_.position).norm() + radius_ + growth;
  return (pose_.position - remembered_.position).norm() +
         lever * (pose_.rotation - remembered_.rotation).norm();
}

double ObstacleMotion::speed(double growth) const {
  return velocity_.norm() + spin_.norm() * ((center_ - pose_.position).norm() + radius_ + growth);
}

}  // namespace deforma
