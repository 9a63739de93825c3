#include "sim/triangle_tree.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace deforma {
namespace {

constexpr Index leaf_size = 4;

double squared_distance_to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

double along(const Vec3& p, const Vec3& a, const Vec3& b) {
  double length = (b - a).squaredNorm();
  return length > 0.0 ? std::clamp((p - a).dot(b - a) / length, 0.0, 1.0) : 0.0;
}

// The closest point of the longest side of a triangle without area.
Vec3 closest_on_longest_side(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  if (ab >= bc && ab >= ca) {
    double t = along(p, a, b);
    return {1.0 - t, t, 0.0};
  }
  if (bc >= ca) {
    double t = along(p, b, c);
    return {0.0, 1.0 - t, t};
  }
  double t = along(p, c, a);
  return {t, 0.0, 1.0 - t};
}

}  // namespace

Vec3 closest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  if (ab.cross(ac).squaredNorm() <= 1e-24 * ab.squaredNorm() * ac.squaredNorm())
    return closest_on_longest_side(p, a, b, c);
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    double t = d1 / (d1 - d3);
    return {1.0 - t, t, 0.0};
  }
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    double t = d2 / (d2 - d6);
    return {1.0 - t, 0.0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - t, t};
  }
  const double sum = va + vb + vc;
  return {1.0 - vb / sum - vc / sum, vb / sum, vc / sum};
}

double corner_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  return std::atan2(ab.cross(ac).norm(), ab.dot(ac));
}

TriangleTree::TriangleTree(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  std::vector<Vec3> centers;
  corners_.reserve(triangles.size());
  centers.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    for (Index corner : t)
      if (corner >= points.size())
        throw std::invalid_argument(
            fmt::format("a triangle names point {}, but there are {}", corner, points.size()));
    corners_.push_back({points[t[0]], points[t[1]], points[t[2]]});
    centers.push_back((points[t[0]] + points[t[1]] + points[t[2]]) / 3.0);
  }
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), Index{0});
  nodes_.reserve(triangles.size());
  if (!triangles.empty()) build(0, static_cast<Index>(triangles.size()), centers);
}

Index TriangleTree::build(Index begin, Index end, std::span<const Vec3> centers) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  Vec3 first = low, last = high;
  for (Index k = begin; k < end; ++k) {
    const Corners& t = corners_[order_[k]];
    low = low.cwiseMin(t.a).cwiseMin(t.b).cwiseMin(t.c);
    high = high.cwiseMax(t.a).cwiseMax(t.b).cwiseMax(t.c);
    first = first.cwiseMin(centers[order_[k]]);
    last = last.cwiseMax(centers[order_[k]]);
  }
  const Index node = static_cast<Index>(nodes_.size());
  nodes_.push_back({low, high, begin, end - begin});
  if (end - begin <= leaf_size) return node;
  int axis = 0;
  (last - first).maxCoeff(&axis);
  const Index middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](Index i, Index j) {
                     double x = centers[i][axis], y = centers[j][axis];
                     return x < y || (x == y && i < j);
                   });
  build(begin, middle, centers);
  const Index second = build(middle, end, centers);
  nodes_[node].first = second;
  nodes_[node].count = 0;
  return node;
}

Closest TriangleTree::closest(const Vec3& point, double reach) const {
  Closest best;
  if (nodes_.empty()) return best;
  double nearest = reach * reach;
  Index stack[64] = {0};
  int depth = 1;
  while (depth > 0) {
    const Index at = stack[--depth];
    const Node& node = nodes_[at];
    if (squared_distance_to_box(point, node.low, node.high) > nearest) continue;
    if (node.count == 0) {
      Index near = at + 1, far = node.first;
      if (squared_distance_to_box(point, nodes_[far].low, nodes_[far].high) <
          squared_distance_to_box(point, nodes_[near].low, nodes_[near].high))
        std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (Index k = node.first; k < node.first + node.count; ++k) {
      const Index t = order_[k];
      const Corners& corner = corners_[t];
      const Vec3 w = closest_barycentric(point, corner.a, corner.b, corner.c);
      const Vec3 q = w[0] * corner.a + w[1] * corner.b + w[2] * corner.c;
      const double squared = (point - q).squaredNorm();
      if (squared > nearest || (squared == nearest && t > best.triangle)) continue;
      nearest = squared;
      best = {t, w, q, 0.0};
    }
  }
  if (best.triangle != Closest::none)
    best.distance = std::sqrt(nearest);
  else
    best.distance = std::numeric_limits<double>::infinity();
  return best;
}

void TriangleTree::within(const Vec3& point, double reach, std::vector<Index>& triangles) const {
  if (nodes_.empty()) return;
  const std::size_t before = triangles.size();
  Index stack[64] = {0};
  int depth = 1;
  while (depth > 0) {
    const Index at = stack[--depth];
    const Node& node = nodes_[at];
    if (squared_distance_to_box(point, node.low, node.high) > reach * reach) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = at + 1;
      continue;
    }
    for (Index k = node.first; k < node.first + node.count; ++k) {
      const Corners& corner = corners_[order_[k]];
      const Vec3 w = closest_barycentric(point, corner.a, corner.b, corner.c);
      if ((point - w[0] * corner.a - w[1] * corner.b - w[2] * corner.c).squaredNorm() <= reach * reach)
        triangles.push_back(order_[k]);
    }
  }
  std::sort(triangles.begin() + static_cast<std::ptrdiff_t>(before), triangles.end());
}

std::size_t TriangleTree::bytes() const {
  return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(Index) +
         corners_.capacity() * sizeof(Corners);
}

}  // namespace deforma
