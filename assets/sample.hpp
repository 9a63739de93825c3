#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "assets/cells.hpp"
#include "assets/mesh.hpp"
#include "assets/surface_points.hpp"

namespace deforma {

enum class Arrangement { lattice, body_centered, blue_noise };

struct SamplingSettings {
  std::size_t particles = 0;  ///< exactly so many; 0: by spacing
  double spacing = 0.0;       ///< d [m]; used when particles is 0
  Arrangement arrangement = Arrangement::lattice;
  double bytes_per_particle = 1024.0;  ///< of memory that each will take, to refuse more than there is
  double jitter = 0.0;  ///< points are moved by up to so many spacings along each axis, in [0, 0.5);
                        ///< those of a single layer stay in it
  std::vector<SurfacePart> held = {};  ///< where points are added on the surface itself
};

struct Sampling {
  std::vector<Eigen::Vector3d> points;  ///< inside the mesh [m]
  std::vector<CellMoments> cells;       ///< of each; their volumes add up to the mesh's
  std::size_t on_surface = 0;           ///< the last so many points were added where the surface is held
  double spacing = 0.0;                 ///< (V/N)^(1/3), of the points inside alone [m]
  std::vector<std::string> warnings;    ///< open mesh, inside-out mesh, ...

  double volume() const;  ///< of all cells [m^3]
};

/// Fills a mesh with particles; the same mesh and settings give the same particles in the same order every time.
/// Inside is where the generalised winding number (Jacobson et al. 2013) is above one half, so that open meshes work
/// (with a warning); an inside-out mesh is sampled as its right-way twin.
///
/// Points inside stop half a spacing short of the surface. Where the surface is to be held, it needs points of its own:
/// each point inside within nine tenths of a spacing gets one where a held part of the surface is nearest to it.
/// @throws std::invalid_argument for settings that make no sense; std::runtime_error when the mesh encloses no volume
///         or the spacing is too wide for it (the message says what spacing it needs) or the count asks for more memory
///         than is sensible (the message says how much).
Sampling sample_interior(const Mesh& mesh, const SamplingSettings& settings);

/// Answers whether the straight way between two points leaves the inside of a mesh.
class Visibility {
 public:
  /// @param spacing of the particles that will look at each other [m]; 0: not known, and every way is walked
  /// @param particles how many there are
  explicit Visibility(const Mesh& mesh, double spacing = 0.0, std::size_t particles = 0);
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
