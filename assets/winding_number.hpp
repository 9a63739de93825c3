#pragma once

#include <Eigen/Core>
#include <vector>

#include "assets/mesh_tree.hpp"

namespace deforma {

/// The generalised winding number of a triangle soup: 1 inside, 0 outside a closed mesh that faces outwards, and a
/// smooth blend of the two where the mesh has holes.
///
/// Triangles nearby by their solid angle (Van Oosterom and Strackee 1983), far ones as dipoles of a tree node with a
/// first-order correction. The error stays below 0.01, far from the 0.5 that divides inside from outside.
/// Source: Jacobson, Kavan and Sorkine-Hornung 2013; Barill, Dickson, Schmidt, Levin and Jacobson 2018, section 3.
class WindingNumber {
 public:
  /// @param tree must outlive this
  explicit WindingNumber(const MeshTree& tree);

  double at(const Eigen::Vector3d& point) const;

 private:
  struct Dipole {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< area-weighted
    Eigen::Vector3d area = Eigen::Vector3d::Zero();    ///< sum of the area vectors [m^2]
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();  ///< sum of offset * area vector^T [m^3]
    double radius = 0.0;                               ///< around the middle, holds every corner [m]
  };

  const MeshTree& tree_;
  std::vector<Dipole> dipoles_;
};

}  // namespace deforma
