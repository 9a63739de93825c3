#include "assets/sample.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "assets/blue_noise.hpp"
#include "assets/lattice.hpp"
#include "assets/solid.hpp"

namespace deforma {

namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double reach_of_held = 0.9;        // spacings: to half the diagonal of a lattice's cell
constexpr std::size_t least_by_spacing = 4;  // fewer do not span a volume

void check_settings(const SamplingSettings& settings) {
  if (!std::isfinite(settings.spacing) || settings.spacing < 0.0)
    throw std::invalid_argument(fmt::format("spacing: expected above 0 m, found {}", settings.spacing));
  if (settings.particles == 0 && settings.spacing == 0.0)
    throw std::invalid_argument("particles, spacing: expected one of them above 0, found 0 for both");
  if (!(settings.jitter >= 0.0 && settings.jitter < 0.5))
    throw std::invalid_argument(
        fmt::format("jitter: expected at least 0 and below 0.5 spacings, found {}", settings.jitter));
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

// The same numbers for the same point each time, whatever the threads.
double uniform(std::uint64_t seed) {
  seed += 0x9E3779B97F4A7C15ull;  // splitmix64 (Steele, Lea & Flood 2014)
  seed = (seed ^ (seed >> 30)) * 0xBF58476D1CE4E5B9ull;
  seed = (seed ^ (seed >> 27)) * 0x94D049BB133111EBull;
  seed ^= seed >> 31;
  return static_cast<double>(seed >> 11) / 4503599627370496.0 - 1.0;
}

// A point that would leave the solid is moved by less; a flat layer of points stays flat.
void jitter(const Solid& solid, double distance, Points& points) {
  constexpr std::uint64_t most_tries = 8;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points) box.extend(point);
  const Eigen::Vector3d reach = (box.sizes().array() > 1e-6 * distance).cast<double>() * distance;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::uint64_t attempt = 0; attempt < most_tries; ++attempt) {
      const std::uint64_t seed = (i * most_tries + attempt) * 3;
      const Eigen::Vector3d random(uniform(seed), uniform(seed + 1), uniform(seed + 2));
      const Eigen::Vector3d moved = points[i] + reach.cwiseProduct(random) / static_cast<double>(attempt + 1);
      if (!solid.contains(moved)) continue;
      points[i] = moved;
      break;
    }
}

// The cell of the cubic lattice that points lie on, from the least step of one coordinate between two of them in order:
// any other distance may be a diagonal. Points far apart are taken for neighbours only where most are: in a plate much
// thinner than its lattice, not in a few islands.
double lattice_spacing(const Points& points, double fallback) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < points.size(); ++i)
    for (double step : (points[i] - points[i - 1]).cwiseAbs())
      if (step > 0.0) least = std::min(least, step);
  if (least < 2.0 * fallback) return least;
  std::size_t neighbors = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    neighbors += (points[i] - points[i - 1]).norm() < 1.01 * least;
  return 2 * neighbors > points.size() ? least : fallback;
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

double Sampling::volume() const {
  double sum = 0.0;
  for (const CellMoments& cell : cells) sum += cell.volume;
  return sum;
}

Sampling sample_interior(const Mesh& mesh, const SamplingSettings& settings) {
  check_settings(settings);
  check_memory("particles", static_cast<double>(settings.particles), settings.bytes_per_particle);
  Solid solid(mesh);
  if (solid.volume() == 0.0)
    throw std::runtime_error(fmt::format("the mesh encloses no volume ({} triangles, {} boundary edges)",
                                         mesh.triangles.size(), solid.facts().boundary_edges));

  const double about = settings.particles > 0 ? static_cast<double>(settings.particles)
                                              : solid.volume() / std::pow(settings.spacing, 3);
  if (settings.particles == 0)
    check_memory(fmt::format("spacing: {} m", settings.spacing), about, settings.bytes_per_particle);
  solid.chart_distances(std::cbrt(solid.volume() / about), static_cast<std::size_t>(about));

  Sampling sampling;
  sampling.warnings = solid.warnings();
  if (settings.particles > 0) {
    sampling.points = fill_by_count(solid, settings.arrangement, settings.particles);
  } else {
    sampling.points = fill_by_spacing(solid, settings.arrangement, settings.spacing);
    if (sampling.points.size() < least_by_spacing)
      refuse_spacing(solid, settings.arrangement, settings.spacing, sampling.points.size());
  }
  sampling.spacing = std::cbrt(solid.volume() / static_cast<double>(sampling.points.size()));
  const bool cubic = settings.arrangement == Arrangement::lattice;
  const double step = cubic ? lattice_spacing(sampling.points, sampling.spacing) : sampling.spacing;
  if (settings.jitter > 0.0) jitter(solid, settings.jitter * step, sampling.points);
  const Points held = points_on_surface(mesh, settings.held, sampling.points, reach_of_held * step);
  sampling.points.insert(sampling.points.end(), held.begin(), held.end());
  sampling.on_surface = held.size();
  sampling.cells = particle_cells(solid, sampling.points, step, cubic && settings.jitter == 0.0);
  return sampling;
}

}  // namespace deforma
