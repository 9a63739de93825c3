#include "tests/bench/bodies.hpp"

#include <tbb/global_control.h>

#include "pipeline/bandwidth.hpp"

namespace deforma {

std::string name_of(BenchKind kind) {
  if (kind == BenchKind::pair) return "pair";
  return kind == BenchKind::linear ? "linear" : "quadratic";
}

Scene BenchBodies::scene(BenchKind kind, int particles) const {
  BenchBody body = bench_box(kind == BenchKind::pair ? particles / 2 : particles);
  body.gradient = kind == BenchKind::quadratic ? Gradient::quadratic : Gradient::linear;
  if (kind != BenchKind::quadratic) body.links = bench_links;
  if (kind != BenchKind::pair) return bench_scene(body);
  Scene scene = bench_pair(body, 0.05);
  for (SceneBody& one : scene.bodies) {
    add_effect(one, "contact");
    add_effect(one, "lennard_jones", {{"depth", Curve<double>(1e-4)}});
  }
  return scene;
}

BenchBodies::Made& BenchBodies::get(BenchKind kind, int particles) {
  if (!made_ || kind != kind_ || particles != particles_) {
    made_.reset();  // two large ones may not fit
    kind_ = kind;
    particles_ = particles;
    Scene described = scene(kind, particles);
    World world = build(described);
    made_ = std::make_unique<Made>(Made{std::move(described), std::move(world)});
  }
  return *made_;
}

double BenchBodies::bandwidth() {
  if (!bandwidth_) {
    tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    bandwidth_ = measure_bandwidth(Turns::Clock::thread);
  }
  return *bandwidth_;
}

std::string case_name(const std::string& stage, BenchKind kind, int particles) {
  return stage + "/" + name_of(kind) + "/" + std::to_string(particles);
}

void count(benchmark::State& iterations, const State& state, double bytes, double bandwidth) {
  using benchmark::Counter;
  const auto repeated = static_cast<double>(iterations.iterations());
  iterations.counters["particle-steps"] =
      Counter(static_cast<double>(state.size()) * repeated, Counter::kIsRate);
  iterations.counters["links"] =
      Counter(static_cast<double>(state.links.links.size()) * repeated, Counter::kIsRate);
  iterations.counters["bytes/step"] = Counter(bytes);
  iterations.counters["of_bandwidth"] = Counter(bytes * repeated / bandwidth, Counter::kIsRate);
}

}  // namespace deforma
