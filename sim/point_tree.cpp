#include "sim/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// Keeps the nearest in the caller's array, which nanoflann's own result set does not: it wants two of full length.
class Nearest {
 public:
  using DistanceType = double;

  Nearest(std::size_t count, std::vector<PointTree::Found>& found) : count_(count), found_(found) {
    found.clear();
  }

  bool full() const { return found_.size() == count_; }
  double worstDist() const { return full() ? found_.back().second : std::numeric_limits<double>::infinity(); }
  bool addPoint(double squared, Index index) {
    if (squared >= worstDist()) return true;  // asked for a whole leaf by the distance before it
    if (full()) found_.pop_back();
    auto after = std::upper_bound(found_.begin(), found_.end(), squared,
                                  [](double s, const PointTree::Found& other) { return s < other.second; });
    found_.insert(after, {index, squared});
    return true;
  }

 private:
  std::size_t count_;
  std::vector<PointTree::Found>& found_;
};

}  // namespace

struct PointTree::Data {
  Cloud cloud;
  Tree tree;

  explicit Data(std::span<const Vec3> points) : cloud{points}, tree(3, cloud) {}
};

PointTree::PointTree(std::span<const Vec3> points) : data_(std::make_unique<Data>(points)) {}
PointTree::~PointTree() = default;

void PointTree::nearest(const Vec3& from, std::size_t count, std::vector<Found>& found) const {
  Nearest result(count, found);
  data_->tree.findNeighbors(result, from.data(), nanoflann::SearchParams());
  for (auto& [index, distance] : found) distance = std::sqrt(distance);
}

void PointTree::within(const Vec3& from, double radius, std::vector<Found>& found) const {
  nanoflann::RadiusResultSet<double, Index> result(radius * radius, found);
  data_->tree.findNeighbors(result, from.data(), nanoflann::SearchParams());
  for (auto& [index, distance] : found) distance = std::sqrt(distance);
}

}  // namespace deforma
