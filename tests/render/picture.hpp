#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "render/renderer.hpp"

/// What several render tests need.
namespace deforma {

/// A folder of its own, removed at the end.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("deforma_" + name + "_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path operator/(const std::string& file) const { return path_ / file; }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  std::filesystem::path path_;
};

/// Red, green, blue, alpha of a pixel, from the upper left.
inline std::array<int, 4> pixel(const Image& image, int x, int y) {
  const std::size_t at =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgba[at], image.rgba[at + 1], image.rgba[at + 2], image.rgba[at + 3]};
}

/// Sum of the three colours.
inline int brightness(const Image& image, int x, int y) {
  const auto p = pixel(image, x, y);
  return p[0] + p[1] + p[2];
}

inline double to_srgb(double linear) {
  return 255.0 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055);
}

inline double to_linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// A mesh with the arrays that a DrawnMesh looks at.
struct Shape {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  DrawnMesh drawn(const Look& look) const { return {points, normals, triangles, look}; }
};

/// A rectangle around `center`, spanned by the half edges u and v; it faces u x v.
Shape rectangle(const Eigen::Vector3d& center, const Eigen::Vector3d& u, const Eigen::Vector3d& v);

/// A sphere of 2 n^2 quads.
Shape ball(const Eigen::Vector3d& center, double radius, int n);

/// Seen from above, x to the right, y up, so that at z = 0 the picture is `height` metres high.
FrameContent from_above(double height, double distance = 10.0);

/// Largest difference of any byte.
int largest_difference(const Image& a, const Image& b);

/// Share of pixels with a colour that differs by more than `limit`.
double share_of_different(const Image& a, const Image& b, int limit);

}  // namespace deforma
