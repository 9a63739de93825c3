#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "assets/distance_chart.hpp"
#include "assets/mesh.hpp"
#include "assets/mesh_tree.hpp"
#include "assets/winding_number.hpp"

namespace deforma {

/// What a mesh encloses. A point is inside when the surface winds around it, whichever way: inside-out parts count as
/// their right-way twins, overlapping parts as their union, and a cavity (a part facing inwards within another one)
/// stays empty. Safe to query from several threads.
class Solid {
 public:
  /// @throws std::invalid_argument for a triangle that names a missing point, or a point that is not finite.
  explicit Solid(const Mesh& mesh);
  Solid(const Solid&) = delete;  // the winding number refers to the tree
  Solid& operator=(const Solid&) = delete;

  const MeshFacts& facts() const { return facts_; }

  /// Enclosed [m^3]: exact for a closed mesh without overlap, counted otherwise; 0 when nothing is enclosed.
  double volume() const { return volume_; }

  /// One sentence for each way in which the mesh is not a plain closed surface.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Whether every edge is walked as often one way as the other; then inside is decided exactly.
  bool closed() const { return closed_; }

  bool contains(const Eigen::Vector3d& point) const;

  /// Marks which of the points (x, y, z0), (x, y, z0 + step), ... are inside, one mark for each element of `inside`.
  void mark_column(double x, double y, double z0, double step, std::vector<char>& inside) const;

  /// Makes distances cheap to ask for far from the surface; no answer changes.
  /// @param spacing of the points that will ask [m]
  /// @param points  how many there are
  void chart_distances(double spacing, std::size_t points) { chart_ = DistanceChart(tree_, spacing, points); }

  /// Distance from a point to the surface [m], or `limit` if that is less.
  double distance(const Eigen::Vector3d& from, double limit) const {
    return chart_.at_least(from) >= limit ? limit : tree_.distance(from, limit);
  }

 private:
  struct Crossing {
    double z;
    int step;  ///< change of the winding number when going up
  };

  bool winds_around(const Eigen::Vector3d& point) const;
  bool cross_column(double x, double y, std::vector<Crossing>& crossings) const;
  double count_column(double x, double y, double length_of_cell, bool& irregular) const;
  double count_volume(bool& irregular) const;

  MeshFacts facts_;
  MeshTree tree_;
  WindingNumber winding_;
  DistanceChart chart_;
  bool closed_ = false;
  double volume_ = 0.0;
  std::vector<std::string> warnings_;
};

}  // namespace deforma
