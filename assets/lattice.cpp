#include "assets/lattice.hpp"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>

namespace deforma {

namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr double clearance =
    1e-3;                        // of the spacing: closer points count as on the surface, which is not inside
constexpr double growth = 1.03;  // of the spacing from one trial to the next while looking for a bracket
constexpr int most_growths = 240;     // a factor of 1200: a plate can be so much thinner than (V / N)^(1/3)
constexpr double least_scale = 0.5;   // eight times as full as needed: such a shift misses a thin solid
constexpr int most_halvings = 10;     // of a bracket of 3 %: down to 3e-5
constexpr double spare_share = 0.02;  // of the points may be left out before shifted lattices are tried
constexpr double fine_share = 0.001;  // of the points may be left out without refining the spacing further
constexpr double far_off = 0.1;  // logarithm of spacing / (V / N)^(1/3) beyond which other lattices are tried
constexpr int shifts_tried = 12;

/// The shift of a lattice against the middle of the bounds, in cells; nothing: chosen for each axis so that the outer
/// points lie as close to half a cell from the bounds as can be.
using Shift = std::optional<Vector3d>;

Vector3d aligned_shift(const Solid& solid, double cell) {
  Vector3d shift;
  for (int axis = 0; axis < 3; ++axis) {
    double cells = std::max(1.0, std::round((solid.facts().max[axis] - solid.facts().min[axis]) / cell));
    shift[axis] = std::fmod(cells, 2.0) == 1.0 ? 0.0 : 0.5;
  }
  return shift;
}

/// The points middle + (k + shift) * cell inside the solid, for whole k, ordered by x, y, z.
void add_cubic(const Solid& solid, double cell, const Vector3d& shift, Points& out) {
  const MeshFacts& facts = solid.facts();
  Vector3d middle = 0.5 * (facts.min + facts.max), half = 0.5 * (facts.max - facts.min);
  Vector3d first = (-half / cell - shift).array().ceil(), last = (half / cell - shift).array().floor();
  if ((last - first).minCoeff() < 0.0) return;
  Vector3d start = middle + cell * (first + shift);
  auto counts = (last - first).cast<std::size_t>().eval();
  std::size_t nx = counts.x() + 1, ny = counts.y() + 1, nz = counts.z() + 1;

  std::vector<Points> rows(nx);
  tbb::parallel_for(std::size_t{0}, nx, [&](std::size_t i) {
    std::vector<char> inside(nz);
    double x = start.x() + cell * static_cast<double>(i);
    for (std::size_t j = 0; j < ny; ++j) {
      double y = start.y() + cell * static_cast<double>(j);
      solid.mark_column(x, y, start.z(), cell, inside);
      for (std::size_t k = 0; k < nz; ++k) {
        if (!inside[k]) continue;
        Vector3d p(x, y, start.z() + cell * static_cast<double>(k));
        if (solid.distance(p, clearance * cell) >= clearance * cell) rows[i].push_back(p);
      }
    }
  });
  for (const Points& row : rows) out.insert(out.end(), row.begin(), row.end());
}

Points fill(const Solid& solid, CellKind kind, double spacing, const Shift& shift) {
  Points points;
  if (kind == CellKind::cubic) {
    add_cubic(solid, spacing, shift.value_or(aligned_shift(solid, spacing)), points);
    return points;
  }
  double cell = spacing * std::cbrt(2.0);
  Vector3d middle = shift.value_or(aligned_shift(solid, cell));
  add_cubic(solid, cell, middle.array() - 0.25, points);
  add_cubic(solid, cell, middle.array() + 0.25, points);
  return points;
}

struct Trial {
  Points points;
  double scale = 1.0;  ///< spacing / (V / N)^(1/3)
};

/// The widest with `count` points or more: walks from scale 1 to where the count passes `count`, then halves the
/// bracket. Gives up where |log scale| passes `worst`.
std::optional<Trial> search(const Solid& solid, CellKind kind, std::size_t count, const Shift& shift,
                            double worst) {
  double base = std::cbrt(solid.volume() / static_cast<double>(count));
  auto at = [&](double scale) { return Trial{fill(solid, kind, base * scale, shift), scale}; };
  // Filling an open mesh takes a winding number per point: there the first lattice that will do is taken.
  double spare = solid.closed() ? fine_share : spare_share;
  auto good_enough = count + static_cast<std::size_t>(spare * static_cast<double>(count));

  Trial enough = at(1.0);
  double too_few = 0.0;
  if (enough.points.size() >= count) {
    for (int i = 0; enough.points.size() > good_enough && too_few == 0.0; ++i) {
      if (i == most_growths) return enough;
      Trial wider = at(enough.scale * growth);
      if (wider.points.size() >= count)
        enough = std::move(wider);
      else
        too_few = wider.scale;
    }
  } else {
    while (enough.points.size() < count) {
      too_few = enough.scale;
      double scale = enough.scale / growth;
      if (scale < least_scale || -std::log(scale) > worst) return std::nullopt;
      enough = at(scale);
    }
  }
  for (int i = 0; i < most_halvings && enough.points.size() > good_enough; ++i) {
    Trial between = at(0.5 * (enough.scale + too_few));
    if (between.points.size() >= count)
      enough = std::move(between);
    else
      too_few = between.scale;
  }
  return enough;
}

/// Points spread evenly over the unit cube: the additive recurrence with the root of x^4 = x + 1 (Roberts 2018).
Vector3d spread(int i) {
  constexpr double root = 1.2207440846057596;
  Vector3d p(1.0 / root, 1.0 / (root * root), 1.0 / (root * root * root));
  p *= i;
  return p.array() - p.array().floor();
}

void leave_out(const Solid& solid, std::size_t count, double spacing, Points& points) {
  if (points.size() == count) return;
  struct Rank {
    double depth;
    double outwards;
    std::size_t index;
  };
  Vector3d middle = 0.5 * (solid.facts().min + solid.facts().max);
  std::vector<Rank> ranks(points.size());
  // Rounded to a millionth of the spacing, so that symmetric points tie and the order alone decides between them.
  auto rounded = [spacing](double length) { return std::round(length / spacing * 1e6); };
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    ranks[i] = {rounded(solid.distance(points[i], 2.0 * spacing)), rounded((points[i] - middle).norm()), i};
  });
  const auto first_kept = ranks.begin() + static_cast<std::ptrdiff_t>(points.size() - count);
  std::nth_element(ranks.begin(), first_kept, ranks.end(), [](const Rank& l, const Rank& r) {
    if (l.depth != r.depth) return l.depth < r.depth;
    if (l.outwards != r.outwards) return l.outwards > r.outwards;
    return l.index < r.index;
  });
  std::vector<char> kept(points.size(), 1);
  for (auto rank = ranks.begin(); rank != first_kept; ++rank) kept[rank->index] = 0;
  Points rest;
  rest.reserve(count);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (kept[i]) rest.push_back(points[i]);
  points = std::move(rest);
}

}  // namespace

Points lattice_by_spacing(const Solid& solid, CellKind kind, double spacing) {
  return fill(solid, kind, spacing, std::nullopt);
}

Points lattice_by_count(const Solid& solid, CellKind kind, std::size_t count) {
  std::vector<Shift> symmetric{std::nullopt}, shifted;
  for (int i = 0; i < 8; ++i)
    symmetric.push_back(Vector3d(0.5 * (i & 1), 0.5 * (i >> 1 & 1), 0.5 * (i >> 2)));
  for (int i = 1; i <= shifts_tried; ++i) shifted.push_back(spread(i));

  std::optional<Trial> best;
  double best_cost = std::numeric_limits<double>::infinity();
  auto good = [&] {
    return best &&
           static_cast<double>(best->points.size() - count) <= spare_share * static_cast<double>(count) &&
           std::abs(std::log(best->scale)) <= far_off;
  };
  for (const auto* shifts : {&symmetric, &shifted})
    for (const Shift& shift : *shifts) {
      if (good()) break;
      std::optional<Trial> trial = search(solid, kind, count, shift, best_cost);
      if (!trial) continue;
      double spare = static_cast<double>(trial->points.size() - count) / static_cast<double>(count);
      double cost = spare + std::abs(std::log(trial->scale));
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = std::move(trial);
    }
  if (!best)
    throw std::runtime_error(
        fmt::format("particles: no lattice has {} points inside the mesh; ask for more", count));
  leave_out(solid, count, best->scale * std::cbrt(solid.volume() / static_cast<double>(count)), best->points);
  return std::move(best->points);
}

}  // namespace deforma
