#include "sim/point_tree.hpp"

#include <cmath>
#include <nanoflann.hpp>

namespace deforma {

namespace {

struct Cloud {
  std::span<const Vec3> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, Index>;

}  // namespace

struct PointTree::Data {
  Cloud cloud;
  Tree tree;

  explicit Data(std::span<const Vec3> points) : cloud{points}, tree(3, cloud) {}
};

PointTree::PointTree(std::span<const Vec3> points) : data_(std::make_unique<Data>(points)) {}
PointTree::~PointTree() = default;

std::vector<PointTree::Found> PointTree::nearest(const Vec3& from, std::size_t count) const {
  std::vector<Index> indices(count);
  std::vector<double> squared(count);
  std::size_t found = data_->tree.knnSearch(from.data(), count, indices.data(), squared.data());
  std::vector<Found> result(found);
  for (std::size_t k = 0; k < found; ++k) result[k] = {indices[k], std::sqrt(squared[k])};
  return result;
}

std::vector<PointTree::Found> PointTree::within(const Vec3& from, double radius) const {
  std::vector<std::pair<Index, double>> result;
  data_->tree.radiusSearch(from.data(), radius * radius, result, nanoflann::SearchParams(32, 0.0F, false));
  for (auto& [index, distance] : result) distance = std::sqrt(distance);
  return result;
}

}  // namespace deforma
