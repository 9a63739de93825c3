#include "sim/solver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/energy_watch.hpp"
#include "sim/huge_pages.hpp"
#include "sim/memory.hpp"
#include "sim/motion.hpp"
#include "sim/parallel.hpp"
#include "sim/step_control.hpp"
#include "sim/stress_stage.hpp"

namespace deforma {

namespace {

constexpr double most_substeps = 1e9;  // in one call: a step so small will never get there

enum Stage { gather_strain, surface_motion, gather_force, integration, step_measurement, stage_count };
constexpr const char* stage_names[stage_count] = {"deformation gradient", "surface", "force gather",
                                                  "integration", "step measurement"};

void check(const SolverSettings& settings) {
  if (!(settings.step_fraction > 0.0 && settings.step_fraction <= 1.0))
    throw std::invalid_argument(
        fmt::format("step_fraction must be in (0, 1], found {}", settings.step_fraction));
  if (!(settings.max_step >= 0.0) || !std::isfinite(settings.max_step))
    throw std::invalid_argument(
        fmt::format("max_step must be positive, or 0 for none, found {} s", settings.max_step));
}

// What every step reads through, much of it out of order.
void keep_in_huge_pages(State& state) {
  use_huge_pages(state.links.links);
  use_huge_pages(state.links.places);
  use_huge_pages(state.fit.there);
  use_huge_pages(state.fit.back);
  use_huge_pages(state.fit.inverse);
  use_huge_pages(state.particles.displacement);
  use_huge_pages(state.F);
}

}  // namespace

struct Solver::Data {
  State state;
  std::vector<std::unique_ptr<Effect>> effects;
  SolverSettings settings;
  SolverStatistics statistics;

  unsigned needs = 0;
  bool strain_tells =
      false;  // a particle that is no longer finite shows in some F, its velocity a step later
  StressStage stress;
  std::vector<Mat3> P;  // that surface forces leave
  std::vector<Vec3> force, surface_force;
  Motion aside;                   // while forces are asked for elsewhere: the state's own
  std::vector<Vec3> force_aside;  // and its force
  std::vector<std::uint8_t> wanted;
  double last_step = 0.0;    // that the state's F lies behind the next [s]
  bool fresh = false;        // strain, near pairs and surface belong to the present state
  bool carried = false;      // and so does the stress that is ready to be gathered
  bool force_known = false;  // velocity Verlet: so does the force
  EnergyWatch watch;
  StepControl control;

  StressStage::Times times() {
    return {statistics.stages[gather_strain], statistics.stages[gather_force], statistics.effects};
  }

  // With the stress in the same pass, unless forces on the surface, which the strain moves, have a part in it.
  void find_strain() {
    if (!(needs & needs_strain)) return;
    carried = !(needs & needs_surface);
    stress.find_strain(state, last_step, carried, control, times());
  }

  void find_initial_rate() {
    if (!(needs & (needs_strain_rate | needs_surface))) return;
    deformation_gradients(state.links, state.fit, state.particles.velocity, state.F_rate);
    for (std::size_t i = 0; i < state.size(); ++i) state.F_rate[i] -= state.fit.projector(i);
  }

  void find_near() {
    bool changed = false;
    run_effects(Effect::at_near, [&](Effect& effect) { changed = effect.near(state) || changed; });
    if (!(needs & needs_surface) || !changed) return;
    std::fill(wanted.begin(), wanted.end(), 0);
    for (const auto& effect : effects) effect->mark(state, wanted);
    state.surface.active.clear();
    for (Index s = 0; s < wanted.size(); ++s)
      if (wanted[s]) state.surface.active.push_back(s);
  }

  void move_surface() {
    if (!(needs & needs_surface)) return;
    PassTimer timer(statistics.stages[surface_motion]);
    move_active(state.surface, state.particles, state.fit, state.F, state.F_rate);
  }

  // What the forces at the present state depend on; once per state, or the rate of F would be lost.
  void refresh() {
    if (fresh) return;
    fresh = true;
    if (needs & needs_surface) {
      find_strain();
      find_near();
      move_surface();
    } else {
      find_near();  // what depends on time, before the stress does
      find_strain();
    }
  }

  void find_force(bool with_stress = true) {
    std::fill(force.begin(), force.end(), Vec3::Zero());
    if (needs & needs_strain) {
      if (needs & needs_surface) {
        std::fill(P.begin(), P.end(), Mat3::Zero());
        for (Index s : state.surface.active) surface_force[s].setZero();
        run_effects(Effect::at_surface_force,
                    [&](Effect& effect) { effect.surface_force(state, surface_force); });
        PassTimer timer(statistics.stages[surface_motion]);
        add_surface_force(state.surface, state.fit, surface_force, P, force);
      }
      if (!carried || !with_stress) stress.carry(state, P, with_stress, times());
      carried = false;
      PassTimer timer(statistics.stages[gather_force]);
      stress.add_force(state, force);
    }
    run_effects(Effect::at_force, [&](Effect& effect) { effect.force(state, force); });
  }

  void find_static_force(std::span<const Vec3> displacement, std::span<Vec3> answer, bool with_stress) {
    refresh();  // what is put aside belongs together
    aside.rest_at(displacement, state);
    force_aside.resize(state.size());
    aside.exchange(state);
    std::swap(force, force_aside);
    carried = false;
    if (needs & needs_strain) deformation_gradients(state.links, state.fit, displacement, state.F);
    find_near();
    move_surface();
    find_force(with_stress);
    std::copy(force.begin(), force.end(), answer.begin());
    aside.exchange(state);
    std::swap(force, force_aside);
    recall_state();
  }

  // Effects remember what they met last: their lists and step bounds must be the state's again.
  void recall_state() {
    find_near();
    if (!(needs & needs_surface)) return;
    move_surface();
    for (Index s : state.surface.active) surface_force[s].setZero();
    run_effects(Effect::at_surface_force,
                [&](Effect& effect) { effect.surface_force(state, surface_force); });
    run_effects(Effect::at_force, [&](Effect& effect) { effect.force(state, force_aside); });
  }

  template <typename Call>
  void run_effects(Effect::Stage stage, const Call& call) {
    for (std::size_t e = 0; e < effects.size(); ++e) {
      if (!effects[e]->takes_part(stage)) continue;
      PassTimer timer(statistics.effects[e]);
      call(*effects[e]);
      if (!effects[e]->takes_part(stage)) timer.discount();
    }
  }

  void prescribe() {
    run_effects(Effect::at_prescribe, [&](Effect& effect) { effect.prescribe(state); });
  }

  void kick(double dt) {
    parallel_for_each(state.size(), [&](std::size_t i) {
      if (state.fixed[i]) return;
      state.particles.velocity[i] += dt / state.particles.mass[i] * force[i];  // eqs 22, 23
    });
  }

  void kick_and_drift(double kick_time, double dt) {
    fresh = false;
    parallel_for_each(state.size(), [&](std::size_t i) {
      Vec3& v = state.particles.velocity[i];
      if (!state.fixed[i]) v += kick_time / state.particles.mass[i] * force[i];  // eqs 22, 23
      state.particles.displacement[i] += dt * v;  // eq 24, with the new velocity
    });
  }

  // Leaves everything at the new time, held particles included.
  void advance_motion(double kick_time, double dt) {
    {
      PassTimer timer(statistics.stages[integration]);
      kick_and_drift(kick_time, dt);
    }
    state.time += dt;
    last_step = dt;
    prescribe();
  }

  void substep(double dt) {
    if (statistics.substeps % EnergyWatch::interval == 0) refuse_energy_from_nowhere();
    control.begin_substep();
    if (settings.integrator == Integrator::symplectic_euler) {
      refresh();
      refuse_wrong_state();
      find_force();
      // The velocity stands half a step behind: with a step that changes, the kick spans the halves on both
      // sides, or every change would pump energy in or out.
      advance_motion(last_step > 0.0 ? 0.5 * (last_step + dt) : dt, dt);
    } else {
      if (!force_known) {
        refresh();
        find_force();
      }
      advance_motion(0.5 * dt, dt);
      refresh();
      refuse_wrong_state();
      find_force();
      force_known = true;
      PassTimer timer(statistics.stages[integration]);
      kick(0.5 * dt);
    }
    run_effects(Effect::at_finish, [&](Effect& effect) { effect.finish(state, dt); });
    ++statistics.substeps;
    statistics.smallest_step = statistics.substeps == 1 ? dt : std::min(statistics.smallest_step, dt);
    statistics.largest_step = std::max(statistics.largest_step, dt);
  }

  void refuse_wrong_state() const {
    if (!strain_tells || !control.finite()) refuse_any_wrong_state();
  }
  void refuse_any_wrong_state() const { refuse_divergence(state, control.finite(), settings.step_fraction); }

  void refuse_energy_from_nowhere() {
    if (watch.wants_ledger(state.particles) && watch.alarmed(state, effects, ledger(), control.keys()))
      refuse_energy(state, settings.step_fraction);
  }

  // Symplectic Euler's velocities stand half a step behind: beside positions they would show energies that swing by as
  // much as the step allows.
  Ledger ledger() {
    refresh();
    if (settings.integrator != Integrator::symplectic_euler || !(last_step > 0.0))
      return measure_ledger(state, effects);
    find_force();
    const std::vector<Vec3> behind = state.particles.velocity;
    kick(0.5 * last_step);
    const Ledger ledger = measure_ledger(state, effects);
    state.particles.velocity = behind;
    return ledger;
  }

  void measure_stiffness() {
    if (!(needs & needs_strain)) return;
    if (!control.stale(state, effects)) return;
    PassTimer timer(statistics.stages[step_measurement]);
    carried = false;
    control.measure(
        state, [&](std::span<const Vec3> u, std::span<Vec3> answer) { stress.answer(state, u, answer); });
  }

  // Limits of springs in parallel on one mass add as the squares of their frequencies.
  double stable_step() {
    measure_stiffness();
    const double strain = control.step();
    double inverse_square = 1.0 / (strain * strain);
    for (const auto& effect : effects) {
      double step = effect->stable_step(state);
      inverse_square += 1.0 / (step * step);
    }
    double step = settings.step_fraction / std::sqrt(inverse_square);
    return settings.max_step > 0.0 ? std::min(step, settings.max_step) : step;
  }
};

Solver::Solver(State state, std::vector<std::unique_ptr<Effect>> effects, const SolverSettings& settings)
    : data_(std::make_unique<Data>()) {
  check(settings);
  Data& d = *data_;
  d.state = std::move(state);
  d.effects = std::move(effects);
  d.settings = settings;
  std::size_t n = d.state.size(), m = d.state.surface.size();
  d.force.resize(n);
  for (const char* name : stage_names) d.statistics.stages.push_back({.name = name});
  for (const auto& effect : d.effects) {
    d.needs |= effect->needs();
    d.statistics.effects.push_back({.name = std::string(effect->name())});
  }
  if (d.needs & (needs_strain_rate | needs_surface | needs_pair_stiffness)) d.needs |= needs_strain;
  d.strain_tells = d.needs & needs_strain && d.state.fit.count_below(1) == 0;
  d.control = StepControl(d.state.bodies.size());
  keep_in_huge_pages(d.state);
  if (d.needs & needs_strain) d.stress = StressStage(d.state, d.effects, d.needs);
  if (d.needs & (needs_strain_rate | needs_surface)) d.state.F_rate.assign(n, Mat3::Zero());
  if (d.needs & needs_surface) {
    d.P.resize(n);
    d.surface_force.assign(m, Vec3::Zero());
    d.wanted.resize(m);
  }
  d.prescribe();  // pins hold from the start
  d.find_initial_rate();
  d.refresh();
}

Solver::~Solver() = default;

void Solver::advance(double seconds) {
  Data& d = *data_;
  if (!(seconds >= 0.0) || !std::isfinite(seconds))
    throw std::invalid_argument(fmt::format("cannot advance by {} s", seconds));
  const double end = d.state.time + seconds;
  for (double remaining = seconds; remaining > 0.0;) {
    double count = std::max(1.0, std::ceil(remaining / d.stable_step() - 1e-9));
    if (!(count < most_substeps)) {
      d.refuse_wrong_state();
      refuse_step(d.state, remaining / count);
    }
    double dt = remaining / count;
    d.substep(dt);
    remaining = count > 1.0 ? remaining - dt : 0.0;
  }
  d.state.time = end;
  d.refresh();
  d.refuse_any_wrong_state();
}

void Solver::static_force(std::span<const Vec3> displacement, std::span<Vec3> force) {
  Data& d = *data_;
  if (displacement.size() != d.state.size() || force.size() != d.state.size())
    throw std::invalid_argument(fmt::format("{} particles but {} displacements and {} forces", d.state.size(),
                                            displacement.size(), force.size()));
  d.find_static_force(displacement, force, true);
  for (std::size_t i = 0; i < force.size(); ++i)
    if (d.state.fixed[i]) force[i].setZero();
}

double Solver::applied_load() {
  Data& d = *data_;
  std::vector<Vec3> applied(d.state.size()), all(d.state.size());
  d.find_static_force(d.state.particles.displacement, applied, false);
  d.find_static_force(d.state.particles.displacement, all, true);
  double on_free = 0.0, on_fixed = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    (d.state.fixed[i] ? on_fixed : on_free) += (d.state.fixed[i] ? all : applied)[i].squaredNorm();
  return std::sqrt(std::max(on_free, on_fixed));
}

void Solver::place(std::span<const Vec3> displacement) {
  Data& d = *data_;
  if (displacement.size() != d.state.size())
    throw std::invalid_argument(
        fmt::format("{} particles but {} displacements", d.state.size(), displacement.size()));
  std::copy(displacement.begin(), displacement.end(), d.state.particles.displacement.begin());
  std::fill(d.state.particles.velocity.begin(), d.state.particles.velocity.end(), Vec3::Zero());
  d.prescribe();
  d.last_step = 0.0;
  d.watch = {};  // who puts particles elsewhere has done work on them
  d.fresh = d.force_known = false;
  d.find_initial_rate();
  d.refresh();
}

double Solver::stable_step() { return data_->stable_step(); }

void Solver::deform(std::span<Vec3> points) const {
  const State& state = data_->state;
  if (data_->needs & needs_strain) {
    deform_surface(state.surface, state.particles, state.fit, state.F, points);
    return;
  }
  std::vector<Mat3> F(state.size());
  deformation_gradients(state.links, state.fit, state.particles.displacement, F);
  deform_surface(state.surface, state.particles, state.fit, F, points);
}

const State& Solver::state() const { return data_->state; }

Ledger Solver::ledger() const { return data_->ledger(); }

const SolverStatistics& Solver::statistics() const {
  Data& d = *data_;
  for (std::size_t e = 0; e < d.effects.size(); ++e) d.statistics.effects[e].bytes = d.effects[e]->bytes();
  auto& stages = d.statistics.stages;
  stages[gather_strain].bytes = strain_bytes(d.state);
  stages[surface_motion].bytes =
      surface_bytes(d.state.surface) + bytes_of(d.surface_force) + bytes_of(d.wanted);
  stages[gather_force].bytes = bytes_of(d.P) + d.stress.bytes() + bytes_of(d.force);
  stages[integration].bytes = particle_bytes(d.state.particles);
  return d.statistics;
}

std::span<const std::unique_ptr<Effect>> Solver::effects() const { return data_->effects; }

}  // namespace deforma
