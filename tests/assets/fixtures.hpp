#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "assets/mesh.hpp"

namespace deforma {

/// A folder for one test's files, gone with the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("deforma_") + test->name() + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Both meshes in one, not welded.
inline Mesh merged(Mesh a, const Mesh& b) {
  auto first = static_cast<std::uint32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& t : b.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return a;
}

inline Mesh flipped(Mesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[2]);
  return mesh;
}

inline Mesh moved(Mesh mesh, const Eigen::Vector3d& by) {
  for (auto& p : mesh.points) p += by;
  return mesh;
}

/// A U: two legs of 1 x 1 x 3 with a slit between them, joined by a bar across their feet.
inline Mesh make_legs(double slit) {
  Mesh mesh;
  // The outline, counter-clockwise seen against y, swept from y = 0 to y = 1.
  const std::vector<std::array<double, 2>> outline = {
      {0, 0}, {2 + slit, 0}, {2 + slit, 3}, {1 + slit, 3}, {1 + slit, 1}, {1, 1}, {1, 3}, {0, 3}};
  for (double y : {0.0, 1.0})
    for (const auto& [x, z] : outline) mesh.points.emplace_back(x, y, z);
  // The front split into convex parts: foot, left leg, right leg.
  const std::vector<std::array<std::uint32_t, 3>> front = {{0, 1, 4}, {0, 4, 5}, {0, 5, 6},
                                                           {0, 6, 7}, {1, 2, 3}, {1, 3, 4}};
  for (auto [a, b, c] : front) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a + 8, c + 8, b + 8});
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    std::uint32_t next = (i + 1) % 8;
    mesh.triangles.push_back({i, i + 8, next + 8});
    mesh.triangles.push_back({i, next + 8, next});
  }
  return mesh;
}

}  // namespace deforma
