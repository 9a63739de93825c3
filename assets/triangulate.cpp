#include "assets/triangulate.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace deforma {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The polygon seen against its mean normal (Newell), so that it turns counter-clockwise.
std::vector<Vector2d> flattened(std::span<const Vector3d> corners) {
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i)
    normal += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
  Vector3d u = normal.unitOrthogonal(), v = normal.normalized().cross(u);
  std::vector<Vector2d> flat;
  flat.reserve(corners.size());
  for (const Vector3d& corner : corners)
    flat.emplace_back(u.dot(corner - corners[0]), v.dot(corner - corners[0]));
  return flat;
}

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

class Outline {
 public:
  explicit Outline(std::vector<Vector2d> points) : points_(std::move(points)), left_(points_.size()) {
    std::iota(left_.begin(), left_.end(), 0u);
  }

  std::size_t size() const { return left_.size(); }

  std::array<std::uint32_t, 3> triangle(std::size_t at) const {
    return {left_[(at + size() - 1) % size()], left_[at], left_[(at + 1) % size()]};
  }

  std::array<std::uint32_t, 3> cut_off(std::size_t at) {
    std::array<std::uint32_t, 3> cut = triangle(at);
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
    return cut;
  }

  /// The corner to cut off next.
  std::size_t next() const {
    std::vector<std::pair<double, std::size_t>> by_cut;
    std::size_t most = 0;
    double most_turn = -1.0;
    for (std::size_t i = 0; i < size(); ++i) {
      auto [a, b, c] = triangle(i);
      double bulge = turn(points_[a], points_[b], points_[c]);
      if (bulge > most_turn) {
        most_turn = bulge;
        most = i;
      }
      if (bulge > 0.0) by_cut.emplace_back((points_[c] - points_[a]).squaredNorm(), i);
    }
    std::sort(by_cut.begin(), by_cut.end());
    for (const auto& [length, i] : by_cut)
      if (is_free(i)) return i;
    return most;
  }

 private:
  /// Whether no other corner lies in the triangle at `at` or on its rim. A corner in the same place as one of the
  /// triangle's own (the two ends of a bridge to a hole) does not count.
  bool is_free(std::size_t at) const {
    auto [a, b, c] = triangle(at);
    const Vector2d &pa = points_[a], &pb = points_[b], &pc = points_[c];
    return std::none_of(left_.begin(), left_.end(), [&](std::uint32_t other) {
      const Vector2d& p = points_[other];
      if (p == pa || p == pb || p == pc) return false;
      return turn(pa, pb, p) >= 0.0 && turn(pb, pc, p) >= 0.0 && turn(pc, pa, p) >= 0.0;
    });
  }

  std::vector<Vector2d> points_;
  std::vector<std::uint32_t> left_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Vector3d> corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (corners.size() < 3) return triangles;
  if (corners.size() == 3) return {{0, 1, 2}};
  Outline outline(flattened(corners));
  while (outline.size() > 3) triangles.push_back(outline.cut_off(outline.next()));
  triangles.push_back(outline.triangle(1));
  return triangles;
}

}  // namespace deforma
