#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "sim/curve.hpp"
#include "sim/skin.hpp"
#include "sim/types.hpp"

namespace deforma {

/// The solid half space on the side that `normal` points away from, through the obstacle's origin.
struct PlaneShape {
  Vec3 normal = Vec3::UnitZ();
};
/// An axis-aligned box in the obstacle's frame. Inside: bodies are kept in it; `open` removes the +z wall and
/// lets the others reach up for ever.
struct BoxShape {
  Vec3 size = Vec3::Ones();  ///< full lengths [m]
  bool inside = false;
  bool open = false;
};
/// A cylinder along the obstacle's z axis, with caps; `inside` and `open` as for the box.
struct CylinderShape {
  double radius = 0.5;  ///< [m]
  double height = 1.0;  ///< full length [m]
  bool inside = false;
  bool open = false;
};
struct SphereShape {
  double radius = 0.5;  ///< [m]
  bool inside = false;
};
/// A closed triangle mesh, solid inside.
struct MeshShape {
  std::vector<Vec3> points;  ///< [m], in the obstacle's frame
  std::vector<Triangle> triangles;
};

using ObstacleShape = std::variant<PlaneShape, BoxShape, CylinderShape, SphereShape, MeshShape>;

/// Where an obstacle is: the position of its origin [m], and how its frame is turned.
struct Pose {
  Vec3 position = Vec3::Zero();
  Mat3 rotation = Mat3::Identity();
};

/// A rigid thing that bodies touch; it moves along keyframes or not at all and feels nothing.
struct Obstacle {
  std::string name;
  ObstacleShape shape;
  Curve<Vec3> position = Vec3(0, 0, 0);  ///< of its origin [m]
  Curve<Vec3> rotation = Vec3(0, 0, 0);  ///< rotation vector [rad]
  double friction = 0.0;                 ///< Coulomb coefficient; a contact uses the larger of the two sides'
  Pose pose_at(double time) const;
};

/// A place where a point has entered something solid, or is close to it.
struct Touch {
  double depth;  ///< how deep [m], negative outside
  Vec3 normal;   ///< unit, the way out: minus the gradient of the depth
};

/// Finds touches of points with obstacles. Holds whatever search structure a mesh needs.
class ObstacleField {
 public:
  explicit ObstacleField(const Obstacle& obstacle);
  ~ObstacleField();
  ObstacleField(ObstacleField&&) noexcept;
  ObstacleField& operator=(ObstacleField&&) noexcept;

  /// Appends every touch of the point (a container's corner gives several: one per wall).
  /// @param point in the obstacle's own frame [m]
  /// @param reach points outside and closer than this touch, too [m]
  void find(const Vec3& point, std::vector<Touch>& touches, double reach = 0.0) const;

  /// A lower bound of the distance to the solid [m]: how far the point may move before it can touch. Zero
  /// inside.
  double clearance(const Vec3& point) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace deforma
