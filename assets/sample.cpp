#include "assets/sample.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "assets/blue_noise.hpp"
#include "assets/lattice.hpp"
#include "assets/solid.hpp"

namespace deforma {

namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr std::size_t least_by_spacing = 4;  // fewer do not span a volume

void check_settings(const SamplingSettings& settings) {
  if (!std::isfinite(settings.spacing) || settings.spacing < 0.0)
    throw std::invalid_argument(fmt::format("spacing: expected above 0 m, found {}", settings.spacing));
  if (settings.particles == 0 && settings.spacing == 0.0)
    throw std::invalid_argument("particles, spacing: expected one of them above 0, found 0 for both");
}

void check_memory(const std::string& asked, double particles, double bytes_each) {
  double needed = particles * bytes_each;
  double present = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (needed > present)
    throw std::runtime_error(fmt::format(
        "{}: {:.4g} particles need about {:.4g} GiB of memory, this machine has {:.4g} GiB; ask for fewer "
        "particles or a wider spacing",
        asked, particles, needed / 0x1p30, present / 0x1p30));
}

Points fill_by_count(const Solid& solid, Arrangement arrangement, std::size_t count) {
  switch (arrangement) {
    case Arrangement::lattice:
      return lattice_by_count(solid, CellKind::cubic, count);
    case Arrangement::body_centered:
      return lattice_by_count(solid, CellKind::body_centered, count);
    case Arrangement::blue_noise:
      return blue_noise(solid, count);
  }
  throw std::invalid_argument("arrangement: expected lattice, body_centered or blue_noise");
}

Points fill_by_spacing(const Solid& solid, Arrangement arrangement, double spacing) {
  switch (arrangement) {
    case Arrangement::lattice:
      return lattice_by_spacing(solid, CellKind::cubic, spacing);
    case Arrangement::body_centered:
      return lattice_by_spacing(solid, CellKind::body_centered, spacing);
    case Arrangement::blue_noise: {
      auto count = static_cast<std::size_t>(std::round(solid.volume() / std::pow(spacing, 3)));
      return count == 0 ? Points{} : blue_noise(solid, count);
    }
  }
  throw std::invalid_argument("arrangement: expected lattice, body_centered or blue_noise");
}

[[noreturn]] void refuse_spacing(const Solid& solid, Arrangement arrangement, double spacing,
                                 std::size_t found) {
  // Told with three digits, so those three are tried.
  auto told = [](double length) { return std::stod(fmt::format("{:.3g}", length)); };
  double needed = told(std::min(spacing, (solid.facts().max - solid.facts().min).norm()));
  while (fill_by_spacing(solid, arrangement, needed).size() < least_by_spacing) needed = told(0.9 * needed);
  throw std::runtime_error(fmt::format(
      "spacing: {} m leaves {} particles in the mesh, expected at least {}: use at most {:.3g} m, or "
      "particles = {} or more",
      spacing, found, least_by_spacing, needed, least_by_spacing));
}

}  // namespace

Sampling sample_interior(const Mesh& mesh, const SamplingSettings& settings) {
  check_settings(settings);
  check_memory("particles", static_cast<double>(settings.particles), settings.bytes_per_particle);
  Solid solid(mesh);
  if (solid.volume() == 0.0)
    throw std::runtime_error(fmt::format("the mesh encloses no volume ({} triangles, {} boundary edges)",
                                         mesh.triangles.size(), solid.facts().boundary_edges));

  Sampling sampling;
  sampling.warnings = solid.warnings();
  if (settings.particles > 0) {
    sampling.points = fill_by_count(solid, settings.arrangement, settings.particles);
  } else {
    check_memory(fmt::format("spacing: {} m", settings.spacing),
                 solid.volume() / std::pow(settings.spacing, 3), settings.bytes_per_particle);
    sampling.points = fill_by_spacing(solid, settings.arrangement, settings.spacing);
    if (sampling.points.size() < least_by_spacing)
      refuse_spacing(solid, settings.arrangement, settings.spacing, sampling.points.size());
  }
  double share = solid.volume() / static_cast<double>(sampling.points.size());
  sampling.volumes.assign(sampling.points.size(), share);
  sampling.spacing = std::cbrt(share);
  return sampling;
}

}  // namespace deforma
