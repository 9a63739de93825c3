#include "picture.hpp"

#include <Eigen/Geometry>
#include <cstdlib>
#include <numbers>

namespace deforma {

Shape rectangle(const Eigen::Vector3d& center, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  Shape shape;
  shape.points = {center - u - v, center + u - v, center + u + v, center - u + v};
  shape.normals.assign(4, u.cross(v).normalized());
  shape.triangles = {{0, 1, 2}, {0, 2, 3}};
  return shape;
}

Shape ball(const Eigen::Vector3d& center, double radius, int n) {
  Shape shape;
  const int around = 2 * n;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = std::numbers::pi * i / n, phi = std::numbers::pi * j / n;
      const Eigen::Vector3d normal(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                   std::cos(theta));
      shape.points.push_back(center + radius * normal);
      shape.normals.push_back(normal);
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < around; ++j) {
      const auto at = [&](int row, int column) {
        return static_cast<std::uint32_t>(row * around + column % around);
      };
      shape.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      shape.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return shape;
}

FrameContent from_above(double height, double distance) {
  FrameContent frame;
  frame.camera.eye = {0.0, 0.0, distance};
  frame.camera.target = {0.0, 0.0, 0.0};
  frame.camera.up = {0.0, 1.0, 0.0};
  frame.camera.field_of_view = 2.0 * std::atan(0.5 * height / distance) * 180.0 / std::numbers::pi;
  return frame;
}

int largest_difference(const Image& a, const Image& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    largest = std::max(largest, std::abs(a.rgba[i] - b.rgba[i]));
  return largest;
}

double share_of_different(const Image& a, const Image& b, int limit) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4)
    for (std::size_t channel = 0; channel < 3; ++channel)
      if (std::abs(a.rgba[i + channel] - b.rgba[i + channel]) > limit) {
        ++different;
        break;
      }
  return static_cast<double>(different) / (static_cast<double>(a.rgba.size()) / 4.0);
}

}  // namespace deforma
