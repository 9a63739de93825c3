#pragma once

#include <vector>

#include "sim/obstacle.hpp"
#include "sim/types.hpp"

namespace deforma {

/// An obstacle where it is now: its shape's answers in world coordinates, and how fast it moves.
class ObstacleMotion {
 public:
  explicit ObstacleMotion(const Obstacle& obstacle);

  void move_to(double time);  ///< [s]

  /// Replaces `touches` by every touch of a point, from `reach` [m] outside on; normals in world coordinates.
  void find(const Vec3& point, std::vector<Touch>& touches, double reach) const;
  /// A lower bound of the distance to the solid [m].
  double clearance(const Vec3& point) const;
  /// Velocity of the obstacle's material at a point [m/s].
  Vec3 velocity_at(const Vec3& point) const;

  /// Whether it moves between two times [s].
  bool varies(double from, double to) const {
    return position_.varies(from, to) || rotation_.varies(from, to);
  }

  double friction() const { return friction_; }
  /// Its smallest extent [m], where the shape tells it.
  double thickness() const { return thickness_; }

  /// Takes the present pose as the one to measure from, for points of a ball.
  void remember(const Vec3& center, double radius);
  /// No point of the ball, grown by `growth`, has moved farther in the obstacle's frame by the obstacle's own
  /// motion [m].
  double moved(double growth) const;
  /// Nor does any move faster [m/s].
  double speed(double growth) const;

 private:
  ObstacleField field_;
  Curve<Vec3> position_, rotation_;
  double friction_;
  double thickness_;
  Pose pose_, remembered_;
  Vec3 velocity_ = Vec3::Zero(), spin_ = Vec3::Zero();
  Vec3 center_ = Vec3::Zero();
  double radius_ = 0.0;
};

}  // namespace deforma
