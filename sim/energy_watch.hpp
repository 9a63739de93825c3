#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/effect.hpp"
#include "sim/ledger.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Notices when a run gains energy that nothing has put in, as it does when its steps are too long.
///
/// Since the last base, the energy that exists now must have been there, or have come out of some potential: with
///     S = K + sum_k |U_k - U_k,base|      (effects k)
/// a sound run has E - E_base below a few per cent of S, and one that makes its own energy approaches S. It is stopped
/// beyond 0.9 S: when a run that began with E_0 has 10 E_0. Whatever does work from outside, such as a moving pin or a
/// load that varies, sets a new base.
///
/// Potentials are costly, so they are asked for only when the kinetic energy has doubled since they last were.
class EnergyWatch {
 public:
  /// Substeps from one look at the kinetic energy to the next.
  static constexpr std::uint64_t interval = 16;

  /// Whether the energies are worth a look.
  bool wants_ledger(const Particles& particles) const;

  /// @param ledger         the energies now
  /// @param stiffness_keys of all effects, per body
  /// @return true when energy has come from nowhere
  bool alarmed(const State& state, std::span<const std::unique_ptr<Effect>> effects, const Ledger& ledger,
               std::span<const double> stiffness_keys);

 private:
  // Where what is held stands; it does no work while this stays.
  struct Held {
    Vec3 sum = Vec3::Zero();
    std::size_t count = 0;
  };
  static Held held(const State& state);
  bool driven(const State& state, std::span<const std::unique_ptr<Effect>> effects,
              std::span<const double> stiffness_keys) const;

  bool based_ = false;
  double time_ = 0.0;          // of the base [s]
  Ledger ledger_;              // then
  std::vector<double> keys_;   // then
  Held held_;                  // then
  double kinetic_seen_ = 0.0;  // the most since [J]
};

}  // namespace deforma
