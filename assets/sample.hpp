#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "assets/mesh.hpp"

namespace deforma {

enum class Arrangement { lattice, body_centered, blue_noise };

struct SamplingSettings {
  std::size_t particles = 0;  ///< exactly so many; 0: by spacing
  double spacing = 0.0;       ///< d [m]; used when particles is 0
  Arrangement arrangement = Arrangement::lattice;
  double bytes_per_particle = 1024.0;  ///< of memory that each will take, to refuse more than there is
};

struct Sampling {
  std::vector<Eigen::Vector3d> points;  ///< inside the mesh [m]
  std::vector<double> volumes;          ///< share of each; they add up to the mesh's volume [m^3]
  double spacing = 0.0;                 ///< (V/N)^(1/3) [m]
  std::vector<std::string> warnings;    ///< open mesh, inside-out mesh, ...
};

/// Fills a mesh with particles; the same mesh and settings give the same particles in the same order every time.
/// Inside is where the generalised winding number (Jacobson et al. 2013) is above one half, so that open meshes work
/// (with a warning); an inside-out mesh is sampled as its right-way twin.
/// @throws std::invalid_argument for settings that make no sense; std::runtime_error when the mesh encloses no volume
///         or the spacing is too wide for it (the message says what spacing it needs) or the count asks for more memory
///         than is sensible (the message says how much).
Sampling sample_interior(const Mesh& mesh, const SamplingSettings& settings);

/// Answers whether the straight way between two points leaves the inside of a mesh.
class Visibility {
 public:
  explicit Visibility(const Mesh& mesh);
  ~Visibility();
  Visibility(Visibility&&) noexcept;
  Visibility& operator=(Visibility&&) noexcept;

  /// True when no triangle of the mesh crosses the open segment a-b. Symmetric, and safe to call from many threads.
  bool sees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace deforma
