#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/effect.hpp"
#include "sim/state.hpp"

namespace deforma {

/// Energies [J] and momenta at one moment.
struct Ledger {
  double kinetic = 0.0;
  std::vector<std::pair<std::string, double>> potential;  ///< per effect
  Vec3 linear_momentum = Vec3::Zero();                    ///< [kg m/s]
  Vec3 angular_momentum = Vec3::Zero();                   ///< about the origin [kg m^2/s]

  double total() const;
};

/// @param state with strain and surface up to date
Ledger measure_ledger(const State& state, std::span<const std::unique_ptr<Effect>> effects);

}  // namespace deforma
