#include "assets/winding_number.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace deforma {

namespace {

using Eigen::Vector3d;

// A node is far when the point is farther than so many of its radii (beta in Barill et al.).
constexpr double opening = 3.0;
double solid_angle(const Vector3d& from, const std::array<Vector3d, 3>& corner) {
  Vector3d a = corner[0] - from, b = corner[1] - from, c = corner[2] - from;
  double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

WindingNumber::WindingNumber(const MeshTree& tree) : tree_(tree), dipoles_(tree.nodes().size()) {
  for (std::size_t n = 0; n < dipoles_.size(); ++n) {
    const MeshTree::Node& node = tree.nodes()[n];
    Dipole& dipole = dipoles_[n];
    double total = 0.0;
    auto each = [&](const auto& add) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const auto& corner = tree.triangles()[i].corner;
        Vector3d area = 0.5 * (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        add(corner, Vector3d((corner[0] + corner[1] + corner[2]) / 3.0), area);
      }
    };
    each([&](const auto&, const Vector3d& middle, const Vector3d& area) {
      dipole.area += area;
      dipole.middle += area.norm() * middle;
      total += area.norm();
    });
    dipole.middle = total > 0.0 ? Vector3d(dipole.middle / total) : node.box.center();
    each([&](const auto& corner, const Vector3d& middle, const Vector3d& area) {
      dipole.moment += (middle - dipole.middle) * area.transpose();
      for (const Vector3d& c : corner) dipole.radius = std::max(dipole.radius, (c - dipole.middle).norm());
    });
  }
}

double WindingNumber::at(const Vector3d& point) const {
  double sum = 0.0;
  tree_.walk(
      [&](std::uint32_t n) {
        const Dipole& dipole = dipoles_[n];
        Vector3d away = dipole.middle - point;
        double square = away.squaredNorm();
        if (square <= opening * opening * dipole.radius * dipole.radius) return true;
        // Eq 11 and 12 of Barill et al.: area . grad G + moment : grad grad G, times 4 pi.
        double cube = square * std::sqrt(square);
        sum += dipole.area.dot(away) / cube + dipole.moment.trace() / cube -
               3.0 * away.dot(dipole.moment * away) / (cube * square);
        return false;
      },
      [&](const MeshTree::Triangle& triangle) {
        sum += solid_angle(point, triangle.corner);
        return true;
      });
  return sum / (4.0 * std::numbers::pi);
}

}  // namespace deforma
