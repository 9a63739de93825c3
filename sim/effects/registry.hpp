#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sim/effect.hpp"
#include "sim/parameters.hpp"

namespace deforma {

/// One body's table for one effect.
struct EffectTable {
  Index body;
  Parameters parameters;
  std::string_view where = {};  ///< file, line and key, for messages; may be empty
};

/// One row of the table of effects.
struct EffectInfo {
  std::string_view name;     ///< the key of its table in a scene
  std::string_view summary;  ///< one line for `deforma effects`
  bool several;              ///< may a body have several tables of it (an array of tables)?
  bool in_world;             ///< may stand in [world], for every body?
  std::span<const Setting> settings;
  /// Builds the one object that serves all bodies with a table of it. `state` is complete but for the
  /// dynamics.
  /// @throws std::invalid_argument when values do not fit together.
  std::unique_ptr<Effect> (*make)(State& state, std::span<const EffectTable> tables);
};

/// Every effect there is, in the order in which they run.
std::span<const EffectInfo> effect_registry();

/// One table of a scene: which effect it calls for, for which body, with what.
struct EffectRequest {
  std::string_view effect;
  EffectTable table;
};

/// Builds every effect that some table calls for, in running order.
/// @throws std::invalid_argument for an unknown effect, an incomplete table, or values that do not fit
/// together; the message begins with the guilty table's `where`. The state is of no use then.
std::vector<std::unique_ptr<Effect>> make_effects(State& state, std::span<const EffectRequest> requests);

/// @throws std::invalid_argument with the nearest name.
const EffectInfo& find_effect(std::string_view name);

}  // namespace deforma
