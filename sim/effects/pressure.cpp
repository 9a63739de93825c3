#include "sim/effects/pressure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/parallel.hpp"
#include "sim/surface_rows.hpp"

namespace deforma {

namespace {

const Setting settings[] = {
    {.key = "value",
     .unit = "Pa",
     .meaning = "pressure from outside; negative pulls outwards",
     .fallback = Curve<double>(0.0),
     .required = true},
};

class Pressure : public Effect {
 public:
  Pressure(const State& state, std::span<const EffectTable> tables) {
    for (const EffectTable& table : tables) {
      const Body& body = state.bodies[table.body];
      pressed_.push_back({body.vertices, body.triangles, table.parameters.number("value"), 0.0,
                          squared_frequency(state, body)});
    }
    list_triangles(state.surface);
  }

  std::string_view name() const override { return "pressure"; }
  unsigned needs() const override { return needs_surface; }

  bool near(const State& state) override {
    for (Pressed& body : pressed_) body.now = body.value.at(state.time);
    return std::exchange(unmarked_, false);
  }

  void mark(const State&, std::span<std::uint8_t> wanted) const override {
    for (const Pressed& body : pressed_)
      std::fill(wanted.begin() + body.vertices.begin, wanted.begin() + body.vertices.end, std::uint8_t{1});
  }

  void surface_force(const State& state, std::span<Vec3> force) override {
    const std::vector<Vec3>& x = state.surface.position;
    for (const Pressed& body : pressed_) {
      if (body.now == 0.0) continue;
      parallel_for_each(body.vertices.size(), [&](std::size_t k) {
        const std::size_t s = body.vertices.begin + k;
        Vec3 area = Vec3::Zero();  // of the triangles around, twice
        for (std::size_t l = start_[s]; l < start_[s + 1]; ++l) {
          const Triangle& t = state.surface.triangles[around_[l]];
          area += (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
        }
        force[s] -= body.now / 6.0 * area;
      });
    }
  }

  double energy(const State& state) const override {
    const std::vector<Vec3>& x = state.surface.position;
    double sum = 0.0;
    for (const Pressed& body : pressed_) {
      double volume = 0.0;
      for (Index k = body.triangles.begin; k < body.triangles.end; ++k) {
        const Triangle& t = state.surface.triangles[k];
        const Vec3& origin = x[body.vertices.begin];  // keeps the digits of a body far from the origin
        volume += (x[t[0]] - origin).dot((x[t[1]] - origin).cross(x[t[2]] - origin)) / 6.0;
      }
      sum += body.now * volume;
    }
    return sum;
  }

  double stable_step(const State& state) const override {
    double largest = 0.0;
    for (const Pressed& body : pressed_)
      largest = std::max(largest, std::abs(body.value.at(state.time)) * body.squared_frequency);
    return largest > 0.0 ? 2.0 / std::sqrt(largest) : std::numeric_limits<double>::infinity();
  }

  bool driven(double from, double to) const override {
    return std::any_of(pressed_.begin(), pressed_.end(),
                       [&](const Pressed& body) { return body.value.varies(from, to); });
  }

  std::size_t bytes() const override {
    return start_.capacity() * sizeof(std::size_t) + around_.capacity() * sizeof(Index);
  }

 private:
  struct Pressed {
    Range vertices, triangles;
    Curve<double> value;
    double now;
    double squared_frequency;  // bound for a pressure of 1 Pa [1/s^2]
  };

  // A triangle's forces change by p/6 times a side for each unit that a corner moves: sum the sides around a
  // vertex.
  static double squared_frequency(const State& state, const Body& body) {
    const std::vector<Vec3>& x = state.surface.rest;
    std::vector<double> stiffness(body.vertices.size(), 0.0);
    for (Index k = body.triangles.begin; k < body.triangles.end; ++k) {
      const Triangle& t = state.surface.triangles[k];
      const double sides =
          (x[t[1]] - x[t[0]]).norm() + (x[t[2]] - x[t[1]]).norm() + (x[t[0]] - x[t[2]]).norm();
      for (Index corner : t) stiffness[corner - body.vertices.begin] += sides / 6.0;
    }
    return largest_squared_frequency(state, make_surface_rows(state, body.vertices), stiffness);
  }

  void list_triangles(const Surface& surface) {
    start_.assign(surface.size() + 1, 0);
    for (const Triangle& t : surface.triangles)
      for (Index corner : t) ++start_[corner + 1];
    for (std::size_t s = 0; s < surface.size(); ++s) start_[s + 1] += start_[s];
    around_.resize(start_.back());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (Index k = 0; k < surface.triangles.size(); ++k)
      for (Index corner : surface.triangles[k]) around_[next[corner]++] = k;
  }

  std::vector<Pressed> pressed_;
  std::vector<std::size_t> start_;  // rows of `around_`, one per vertex
  std::vector<Index> around_;       // triangles
  bool unmarked_ = true;
};

}  // namespace

const EffectInfo& pressure_effect() {
  static const EffectInfo info = {
      .name = "pressure",
      .summary = "presses on the whole surface from outside, as air does",
      .several = false,
      .in_world = true,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<Pressure>(state, tables);
      }};
  return info;
}

}  // namespace deforma
