#include "sim/solver.hpp"

#include <fmt/core.h>
#include <tbb/parallel_reduce.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sim/energy_watch.hpp"
#include "sim/internal_force.hpp"
#include "sim/material.hpp"
#include "sim/parallel.hpp"
#include "sim/stiffness.hpp"

namespace deforma {

namespace {

constexpr double most_substeps = 1e9;  // in one call: a step so small will never get there
constexpr double exploded = 1e6;       // a deformation gradient this large is no deformation any more

constexpr double most_strain_change = 0.2;  // in one step, relative: else the stiffness at its end is another
constexpr double step_growth = 1.05;        // from one step to the next

enum Stage { gather_strain, surface_motion, gather_force, integration, step_measurement, stage_count };
constexpr const char* stage_names[stage_count] = {"deformation gradient", "surface", "force gather",
                                                  "integration", "step measurement"};

class Timer {
 public:
  explicit Timer(SolverStatistics::Pass& pass) : pass_(pass), start_(std::chrono::steady_clock::now()) {}
  ~Timer() {
    pass_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    pass_.calls += counted_;
  }
  void discount() { counted_ = 0; }  // what was timed did nothing
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  SolverStatistics::Pass& pass_;
  std::uint64_t counted_ = 1;
  std::chrono::steady_clock::time_point start_;
};

// How much stiffer than at rest a material can have become under F, but for a constant: what multiplies the moduli in
// the second derivatives of the energies in use. The norm of F alone would not tell a pulled particle from a flattened
// one, whose cofactors are many times larger.
double stiffening(const Mat3& F) {
  const Mat3 C = cofactor(F);
  const double squared = F.squaredNorm();
  return 0.5 + squared + C.squaredNorm() + std::abs(F.col(0).dot(C.col(0)) - 1.0) * std::sqrt(squared);
}

struct StrainNow {
  double stiffening = 0.0;  // the largest; infinity when some F is not finite, or beyond reason
  double change = 0.0;      // the largest since the last step, squared, relative
};

StrainNow survey(std::span<const Mat3> F, std::span<const Mat3> F_before, Range particles) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(particles.begin, particles.end, 4096), StrainNow{},
      [&](const tbb::blocked_range<std::size_t>& block, StrainNow now) {
        for (std::size_t i = block.begin(); i != block.end(); ++i) {
          const double squared = F[i].squaredNorm();
          if (!(squared < exploded * exploded))
            return StrainNow{std::numeric_limits<double>::infinity(), 0.0};
          now.stiffening = std::max(now.stiffening, stiffening(F[i]));
          now.change = std::max(now.change, (F[i] - F_before[i]).squaredNorm() / std::max(squared, 1.0));
        }
        return now;
      },
      [](const StrainNow& a, const StrainNow& b) {
        return StrainNow{std::max(a.stiffening, b.stiffening), std::max(a.change, b.change)};
      });
}

void check(const SolverSettings& settings) {
  if (!(settings.step_fraction > 0.0 && settings.step_fraction <= 1.0))
    throw std::invalid_argument(
        fmt::format("step_fraction must be in (0, 1], found {}", settings.step_fraction));
  if (!(settings.max_step >= 0.0) || !std::isfinite(settings.max_step))
    throw std::invalid_argument(
        fmt::format("max_step must be positive, or 0 for none, found {} s", settings.max_step));
}

}  // namespace

struct Solver::Data {
  State state;
  std::vector<std::unique_ptr<Effect>> effects;
  SolverSettings settings;
  SolverStatistics statistics;

  unsigned needs = 0;
  std::vector<Mat3> P, B, F_before;
  std::vector<double> pair_stiffness;
  std::vector<Vec3> force, surface_force;
  std::vector<std::uint8_t> wanted;
  double last_step = 0.0;    // that F_before lies behind F [s]
  bool fresh = false;        // strain, near pairs and surface belong to the present state
  bool force_known = false;  // velocity Verlet: so does the force

  EnergyWatch watch;
  StiffnessProbe probe;
  StiffnessProbe::Conditions conditions;  // now
  double omega = 0.0;                     // measured highest frequency [rad/s]
  double strain_rate = 0.0;               // the largest relative change of F in the last step [1/s]
  double strain_step_now = std::numeric_limits<double>::infinity();
  double strain_step_before = std::numeric_limits<double>::infinity();  // in the last substep

  double smallest_spacing() const {
    double smallest = std::numeric_limits<double>::infinity();
    for (const Body& body : state.bodies) smallest = std::min(smallest, body.spacing);
    return smallest;
  }

  void find_strain() {
    if (!(needs & needs_strain)) return;
    Timer timer(statistics.stages[gather_strain]);
    std::swap(state.F, F_before);
    deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
    double change = 0.0;
    for (std::size_t b = 0; b < state.bodies.size(); ++b) {
      const StrainNow now = survey(state.F, F_before, state.bodies[b].particles);
      conditions.stiffening[b] = now.stiffening;
      change = std::max(change, now.change);
    }
    strain_rate = last_step > 0.0 ? std::sqrt(change) / last_step : 0.0;
    if (!(needs & (needs_strain_rate | needs_surface))) return;
    if (last_step > 0.0) {
      // F is linear in u and u advanced by v dt, so this quotient is the gradient of the velocity.
      parallel_for_each(state.size(),
                        [&](std::size_t i) { state.F_rate[i] = (state.F[i] - F_before[i]) / last_step; });
    }
  }

  void find_initial_rate() {
    if (!(needs & (needs_strain_rate | needs_surface))) return;
    deformation_gradients(state.links, state.fit, state.particles.velocity, state.F_rate);
    for (std::size_t i = 0; i < state.size(); ++i) state.F_rate[i] -= state.fit.plane[i];
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
    Timer timer(statistics.stages[surface_motion]);
    Surface& surface = state.surface;
    parallel_for_each(
        surface.active.size(),
        [&](std::size_t a) {
          Index s = surface.active[a];
          Vec3 u = Vec3::Zero(), v = Vec3::Zero();
          for (const Skin::Tie& tie : surface.skin.row(s)) {  // eq 25, and its rate
            Index i = tie.particle;
            u += tie.weight * (state.particles.displacement[i] + (state.F[i] - state.fit.plane[i]) * tie.arm);
            v += tie.weight * (state.particles.velocity[i] + state.F_rate[i] * tie.arm);
          }
          surface.position[s] = surface.rest[s] + u;
          surface.velocity[s] = v;
        },
        64);
  }

  // What the forces at the present state depend on; once per state, or the rate of F would be lost.
  void refresh() {
    if (fresh) return;
    fresh = true;
    find_strain();
    find_near();
    move_surface();
  }

  void find_force(bool with_stress = true) {
    std::fill(force.begin(), force.end(), Vec3::Zero());
    if (needs & needs_strain) {
      std::fill(P.begin(), P.end(), Mat3::Zero());
      if (needs & needs_surface) {
        for (Index s : state.surface.active) surface_force[s].setZero();
        run_effects(Effect::at_surface_force,
                    [&](Effect& effect) { effect.surface_force(state, surface_force); });
        Timer timer(statistics.stages[surface_motion]);
        add_surface_force(state.surface, state.fit, surface_force, P, force);
      }
      if (with_stress)
        run_effects(Effect::at_stress,
                    [&](Effect& effect) { effect.stress(state, state.F, P, pair_stiffness); });
      else
        std::fill(pair_stiffness.begin(), pair_stiffness.end(), 0.0);
      Timer timer(statistics.stages[gather_force]);
      carried_stress(state.particles, state.links, state.fit, state.particles.displacement, state.F, P,
                     pair_stiffness, B, force);
      add_internal_force(state.links, state.fit, B, pair_stiffness, state.particles.displacement, force);
    }
    run_effects(Effect::at_force, [&](Effect& effect) { effect.force(state, force); });
  }

  // What depends on where particles are and how they move: exchanged for another while forces are asked for there.
  struct Motion {
    std::vector<Vec3> displacement, velocity;
    std::vector<Mat3> F, F_rate;
    std::vector<Vec3> position, surface_velocity;
    std::vector<Vec3> force;
  };
  Motion aside;

  void exchange_motion() {
    std::swap(state.particles.displacement, aside.displacement);
    std::swap(state.particles.velocity, aside.velocity);
    std::swap(state.F, aside.F);
    std::swap(state.F_rate, aside.F_rate);
    std::swap(state.surface.position, aside.position);
    std::swap(state.surface.velocity, aside.surface_velocity);
    std::swap(force, aside.force);
  }

  void find_static_force(std::span<const Vec3> displacement, std::span<Vec3> answer, bool with_stress) {
    refresh();  // what is put aside belongs together
    aside.displacement.assign(displacement.begin(), displacement.end());
    aside.velocity.assign(state.size(), Vec3::Zero());
    aside.F.resize(state.F.size());
    aside.F_rate.assign(state.F_rate.size(), Mat3::Zero());
    aside.position.resize(state.surface.position.size());
    aside.surface_velocity.resize(state.surface.velocity.size());
    aside.force.resize(state.size());
    exchange_motion();
    if (needs & needs_strain) deformation_gradients(state.links, state.fit, displacement, state.F);
    find_near();
    move_surface();
    find_force(with_stress);
    std::copy(force.begin(), force.end(), answer.begin());
    exchange_motion();
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
    run_effects(Effect::at_force, [&](Effect& effect) { effect.force(state, aside.force); });
  }

  template <typename Call>
  void run_effects(Effect::Stage stage, const Call& call) {
    for (std::size_t e = 0; e < effects.size(); ++e) {
      if (!effects[e]->takes_part(stage)) continue;
      Timer timer(statistics.effects[e]);
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

  void drift(double dt) {
    fresh = false;
    parallel_for_each(state.size(), [&](std::size_t i) {
      state.particles.displacement[i] += dt * state.particles.velocity[i];  // eq 24, with the new velocity
    });
  }

  // Leaves everything at the new time, held particles included.
  void advance_motion(double kick_time, double dt) {
    {
      Timer timer(statistics.stages[integration]);
      kick(kick_time);
      drift(dt);
    }
    state.time += dt;
    last_step = dt;
    prescribe();
  }

  void substep(double dt) {
    if (statistics.substeps % EnergyWatch::interval == 0) refuse_energy_from_nowhere();
    strain_step_before = strain_step_now;
    if (settings.integrator == Integrator::symplectic_euler) {
      refresh();
      refuse_divergence();
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
      refuse_divergence();
      find_force();
      force_known = true;
      Timer timer(statistics.stages[integration]);
      kick(0.5 * dt);
    }
    run_effects(Effect::at_finish, [&](Effect& effect) { effect.finish(state, dt); });
    ++statistics.substeps;
    statistics.smallest_step = statistics.substeps == 1 ? dt : std::min(statistics.smallest_step, dt);
    statistics.largest_step = std::max(statistics.largest_step, dt);
  }

  void refuse_divergence() const {
    bool finite_strain = std::all_of(conditions.stiffening.begin(), conditions.stiffening.end(),
                                     [](double stiffening) { return std::isfinite(stiffening); });
    for (std::size_t i = 0; i < state.size(); ++i) {
      bool fine = state.particles.displacement[i].allFinite() && state.particles.velocity[i].allFinite() &&
                  (finite_strain || state.F[i].squaredNorm() < exploded * exploded);
      if (fine) continue;
      const Body& body = state.bodies[state.particles.body[i]];
      throw SimulationDiverged(
          fmt::format("the simulation diverged at t = {:.6g} s: body '{}', particle {} is no longer finite "
                      "or is stretched beyond "
                      "{:g} times; lower [solver] step_fraction (now {:g}), or soften what drives it",
                      state.time, body.name, i - body.particles.begin, exploded, settings.step_fraction));
    }
  }

  void refuse_energy_from_nowhere() {
    double kinetic = 0.0;
    for (std::size_t i = 0; i < state.size(); ++i)
      kinetic += 0.5 * state.particles.mass[i] * state.particles.velocity[i].squaredNorm();
    if (!watch.wants_ledger(kinetic)) return;
    if (!watch.alarmed(state, effects, ledger(), conditions.key)) return;
    const std::size_t i = most_energetic(state);
    const Body& body = state.bodies[state.particles.body[i]];
    throw SimulationDiverged(fmt::format(
        "the simulation went wrong by t = {:.6g} s: it has gained several times the energy that was put "
        "in, most of it now at body '{}', particle {}; lower [solver] step_fraction (now {:g}), or soften "
        "what drives it",
        state.time, body.name, i - body.particles.begin, settings.step_fraction));
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

  [[noreturn]] void refuse_vanishing_step(double step) const {
    refuse_divergence();
    throw SimulationDiverged(
        fmt::format("the simulation cannot go on at t = {:.6g} s: its stable step has fallen to {:.3g} s; "
                    "something moves or is "
                    "stiff beyond reason: look at velocities, 'young' and contact 'stiffness'",
                    state.time, step));
  }

  // The force that answers strain alone, at other displacements than the state's.
  void strain_force(std::span<const Vec3> displacement, std::span<Vec3> answer, std::vector<Mat3>& F) {
    deformation_gradients(state.links, state.fit, displacement, F);
    std::fill(P.begin(), P.end(), Mat3::Zero());
    for (const auto& effect : effects)
      if (!(effect->needs() & needs_strain_rate)) effect->stress(state, F, P, pair_stiffness);
    std::fill(answer.begin(), answer.end(), Vec3::Zero());
    carried_stress(state.particles, state.links, state.fit, displacement, F, P, pair_stiffness, B, answer);
    add_internal_force(state.links, state.fit, B, pair_stiffness, displacement, answer);
  }

  void measure_stiffness() {
    if (!(needs & needs_strain)) return;
    std::fill(conditions.key.begin(), conditions.key.end(), 0.0);
    for (const auto& effect : effects) effect->stiffness_key(state, conditions.key);
    if (!probe.stale(conditions)) return;
    Timer timer(statistics.stages[step_measurement]);
    std::vector<Mat3> F(state.size());
    omega =
        probe.measure(state.particles.displacement, state.particles.mass, state.fixed, smallest_spacing(),
                      [&](std::span<const Vec3> u, std::span<Vec3> answer) { strain_force(u, answer, F); });
    probe.remember(conditions);
  }

  // What strain allows, up to the step fraction [s]. It stays while the stiffness is about the same, may shrink at once
  // and grows slowly: a step that followed every swing of a vibration, if only by 1 %, would feed it.
  double strain_step() {
    measure_stiffness();
    double step = omega > 0.0 ? 2.0 / omega : std::numeric_limits<double>::infinity();
    if (strain_rate > 0.0) step = std::min(step, most_strain_change / strain_rate);
    return strain_step_now = std::min(step, step_growth * strain_step_before);
  }

  // Limits of springs in parallel on one mass add as the squares of their frequencies.
  double stable_step() {
    const double strain = strain_step();
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
  d.conditions.stiffening.assign(d.state.bodies.size(), 0.0);
  d.conditions.key.assign(d.state.bodies.size(), 0.0);
  if (d.needs & needs_strain) {
    d.P.resize(n);
    d.B.resize(n);
    if (d.needs & needs_pair_stiffness) d.pair_stiffness.assign(n, 0.0);
  }
  d.F_before = d.state.F;
  if (d.needs & needs_surface) {
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
  double remaining = seconds;
  while (remaining > 0.0) {
    double count = std::max(1.0, std::ceil(remaining / d.stable_step() - 1e-9));
    if (!(count < most_substeps)) d.refuse_vanishing_step(remaining / count);
    double dt = remaining / count;
    d.substep(dt);
    remaining = count > 1.0 ? remaining - dt : 0.0;
  }
  d.state.time = end;
  d.refresh();
  d.refuse_divergence();
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
  const State& s = d.state;
  auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  d.statistics.stages[gather_strain].bytes =
      bytes(s.links.links) + bytes(s.links.start) + bytes(s.fit.inverse) + bytes(s.fit.plane) +
      bytes(s.fit.rank) + bytes(s.fit.trace) + bytes(s.fit.pairs) + bytes(s.fit.sums) +
      bytes(s.links.support) + bytes(s.links.length) + bytes(s.F) + bytes(s.F_rate) + bytes(d.F_before);
  d.statistics.stages[surface_motion].bytes = bytes(s.surface.skin.ties) + bytes(s.surface.position) +
                                              bytes(s.surface.velocity) + bytes(s.surface.rest) +
                                              bytes(s.surface.triangles) + bytes(s.surface.skin.start) +
                                              bytes(d.surface_force) + bytes(d.wanted);
  d.statistics.stages[gather_force].bytes =
      bytes(d.P) + bytes(d.B) + bytes(d.pair_stiffness) + bytes(d.force);
  d.statistics.stages[integration].bytes = bytes(s.particles.rest) + bytes(s.particles.displacement) +
                                           bytes(s.particles.velocity) + bytes(s.particles.mass) +
                                           bytes(s.particles.volume);
  return d.statistics;
}

std::span<const std::unique_ptr<Effect>> Solver::effects() const { return data_->effects; }

}  // namespace deforma
