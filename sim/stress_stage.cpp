#include "sim/stress_stage.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include "sim/parallel.hpp"

namespace deforma {

namespace {

constexpr std::size_t blocks_at_a_time = 4;  // for one thread; as few in all are not worth a second one

using Seconds = std::chrono::duration<double>;

template <typename Visit>
void for_blocks(std::span<const Block> blocks, const Visit& visit) {
  parallel_for_each(
      blocks.size(), [&](std::size_t b) { visit(b, blocks[b]); }, blocks_at_a_time);
}

/// A block's stress and pair stiffness, from nothing.
struct Scratch {
  std::array<Mat3, Block::most> F, P;
  std::array<double, Block::most> pair_stiffness;

  std::span<Mat3> empty_P(const Block& block) {
    std::fill_n(P.begin(), block.size(), Mat3::Zero());
    return std::span(P).first(block.size());
  }
  std::span<double> empty_pair_stiffness(const Block& block, unsigned needs) {
    if (!(needs & needs_pair_stiffness)) return {};
    std::fill_n(pair_stiffness.begin(), block.size(), 0.0);
    return std::span(pair_stiffness).first(block.size());
  }
};

}  // namespace

/// Times the parts of a pass in every block, on whatever thread it runs, and shares out what the pass took in all: the
/// parts of two threads that work at once are not to count twice.
class StressStage::Clock {
 public:
  Clock(std::size_t blocks, std::size_t parts) : parts_(parts), laps_(blocks * parts, 0.0) {}

  class Laps {
   public:
    explicit Laps(std::span<double> laps) : laps_(laps), last_(std::chrono::steady_clock::now()) {}
    void lap(std::size_t part) {
      const auto now = std::chrono::steady_clock::now();
      laps_[part] += Seconds(now - last_).count();
      last_ = now;
    }

   private:
    std::span<double> laps_;
    std::chrono::steady_clock::time_point last_;
  };

  Laps start(std::size_t block) { return Laps(std::span(laps_).subspan(block * parts_, parts_)); }

  /// @param passes one for each part; null where there is none
  void share_out(std::span<SolverStatistics::Pass* const> passes) const {
    const double whole = Seconds(std::chrono::steady_clock::now() - begin_).count();
    std::vector<double> sums(parts_, 0.0);
    double all = 0.0;
    for (std::size_t k = 0; k < laps_.size(); ++k) {
      sums[k % parts_] += laps_[k];
      all += laps_[k];
    }
    for (std::size_t part = 0; part < parts_; ++part) {
      if (!passes[part]) continue;
      passes[part]->seconds += all > 0.0 ? whole * sums[part] / all : 0.0;
      ++passes[part]->calls;
    }
  }

 private:
  std::size_t parts_;
  std::vector<double> laps_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

StressStage::StressStage(const State& state, std::span<const std::unique_ptr<Effect>> effects, unsigned needs)
    : blocks_(make_blocks(state.bodies)),
      needs_(needs),
      internal_(state, needs & needs_pair_stiffness),
      surveys_(blocks_.size()) {
  for (std::size_t e = 0; e < effects.size(); ++e) {
    if (!blocks_.empty()) effects[e]->stress(state, {blocks_.front().body, {0, 0}}, {}, {}, {});
    if (!effects[e]->takes_part(Effect::at_stress)) continue;
    effects_.push_back(effects[e].get());
    places_.push_back(e);
  }
}

void StressStage::find_strain(State& state, double last_step, bool with_stress, StepControl& control,
                              Times times) {
  const std::size_t strain = effects_.size(), carried = effects_.size() + 1;
  Clock clock(blocks_.size(), effects_.size() + 2);
  const bool with_rate = needs_ & (needs_strain_rate | needs_surface) && last_step > 0.0;
  const std::span<const Vec3> u(state.particles.displacement);
  for_blocks(blocks_, [&](std::size_t b, const Block& block) {
    Clock::Laps laps = clock.start(b);
    Scratch scratch;
    const std::span<Mat3> F = std::span(scratch.F).first(block.size());
    block_deformation_gradients(state.links, state.fit, u, block.particles, F);
    const std::span<Mat3> before = part(state.F, block);
    surveys_[b] = {};
    surveys_[b].look(F, before, state.links.loops());
    // F is linear in u and u advanced by v dt, so this quotient is the gradient of the velocity.
    if (with_rate)
      for (std::size_t k = 0; k < block.size(); ++k)
        state.F_rate[block.particles.begin + k] = (F[k] - before[k]) / last_step;
    std::copy(F.begin(), F.end(), before.begin());
    laps.lap(strain);
    if (!with_stress) return;
    const std::span<Mat3> P = scratch.empty_P(block);
    const std::span<double> s = scratch.empty_pair_stiffness(block, needs_);
    for (std::size_t e = 0; e < effects_.size(); ++e) {
      effects_[e]->stress(state, block, F, P, s);
      laps.lap(e);
    }
    internal_.carry(state, block.particles, u, F, P, s);
    laps.lap(carried);
  });
  std::vector<SolverStatistics::Pass*> passes(effects_.size() + 2, nullptr);
  passes[strain] = &times.strain;
  if (with_stress) {
    for (std::size_t e = 0; e < effects_.size(); ++e) passes[e] = &times.effects[places_[e]];
    passes[carried] = &times.carry;
  }
  clock.share_out(passes);
  control.observe(blocks_, surveys_, last_step);
}

void StressStage::carry(const State& state, std::span<Mat3> P, bool with_effects, Times times) {
  const std::size_t carried = effects_.size();
  Clock clock(blocks_.size(), effects_.size() + 1);
  for_blocks(blocks_, [&](std::size_t b, const Block& block) {
    Clock::Laps laps = clock.start(b);
    Scratch scratch;
    const std::span<const Mat3> F = part(state.F, block);
    const std::span<Mat3> own =
        P.empty() ? scratch.empty_P(block) : P.subspan(block.particles.begin, block.size());
    const std::span<double> s = scratch.empty_pair_stiffness(block, needs_);
    laps.lap(carried);
    if (with_effects)
      for (std::size_t e = 0; e < effects_.size(); ++e) {
        effects_[e]->stress(state, block, F, own, s);
        laps.lap(e);
      }
    internal_.carry(state, block.particles, state.particles.displacement, F, own, s);
    laps.lap(carried);
  });
  std::vector<SolverStatistics::Pass*> passes(effects_.size() + 1, nullptr);
  if (with_effects)
    for (std::size_t e = 0; e < effects_.size(); ++e) passes[e] = &times.effects[places_[e]];
  passes[carried] = &times.carry;
  clock.share_out(passes);
}

void StressStage::answer(const State& state, std::span<const Vec3> displacement, std::span<Vec3> force) {
  for_blocks(blocks_, [&](std::size_t, const Block& block) {
    Scratch scratch;
    const std::span<Mat3> F = std::span(scratch.F).first(block.size());
    block_deformation_gradients(state.links, state.fit, displacement, block.particles, F);
    const std::span<Mat3> P = scratch.empty_P(block);
    const std::span<double> s = scratch.empty_pair_stiffness(block, needs_);
    for (Effect* effect : effects_)
      if (!(effect->needs() & needs_strain_rate)) effect->stress(state, block, F, P, s);
    internal_.carry(state, block.particles, displacement, F, P, s);
    std::fill_n(force.begin() + block.particles.begin, block.size(), Vec3::Zero());
  });
  internal_.add_to(force, state);
}

}  // namespace deforma
