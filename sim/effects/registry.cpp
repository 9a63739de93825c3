#include "sim/effects/registry.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "sim/effects/contact.hpp"
#include "sim/effects/damping.hpp"
#include "sim/effects/elastic.hpp"
#include "sim/effects/gravity.hpp"
#include "sim/effects/hourglass.hpp"
#include "sim/effects/lennard_jones.hpp"
#include "sim/effects/load.hpp"
#include "sim/effects/pin.hpp"
#include "sim/effects/pressure.hpp"
#include "sim/effects/volume.hpp"

namespace deforma {

std::span<const EffectInfo> effect_registry() {
  // The running order: stress, then forces, then what acts after the integration. Pins come last, they prescribe.
  static const EffectInfo registry[] = {
      elastic_effect(), hourglass_effect(), volume_effect(),        contact_effect(), pressure_effect(),
      load_effect(),    gravity_effect(),   lennard_jones_effect(), damping_effect(), pin_effect(),
  };
  return registry;
}

const EffectInfo& find_effect(std::string_view name) {
  std::vector<std::string_view> names;
  for (const EffectInfo& info : effect_registry()) {
    if (info.name == name) return info;
    names.push_back(info.name);
  }
  std::string nearest = nearest_name(name, names);
  throw std::invalid_argument(fmt::format("unknown effect '{}'{} (allowed: {})", name,
                                          nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest),
                                          fmt::join(names, ", ")));
}

namespace {

std::invalid_argument error_at(const EffectTable& table, const std::invalid_argument& error) {
  return std::invalid_argument(table.where.empty() ? error.what()
                                                   : fmt::format("{}: {}", table.where, error.what()));
}

std::unique_ptr<Effect> make_effect(const EffectInfo& info, State& state,
                                    std::span<const EffectTable> tables) {
  try {
    return info.make(state, tables);
  } catch (const std::invalid_argument& error) {
    // An effect sees all its tables at once; the guilty one fails alone, too.
    for (const EffectTable& table : tables) {
      try {
        info.make(state, {&table, 1});
      } catch (const std::invalid_argument& own_error) {
        throw error_at(table, own_error);
      }
    }
    throw error_at(tables.front(), error);
  }
}

}  // namespace

std::vector<std::unique_ptr<Effect>> make_effects(State& state, std::span<const EffectRequest> requests) {
  for (const EffectRequest& request : requests) {
    try {
      find_effect(request.effect);
      request.table.parameters.require_complete();
    } catch (const std::invalid_argument& error) {
      throw error_at(request.table, error);
    }
  }
  std::vector<std::unique_ptr<Effect>> effects;
  for (const EffectInfo& info : effect_registry()) {
    std::vector<EffectTable> tables;
    for (const EffectRequest& request : requests)
      if (request.effect == info.name) tables.push_back(request.table);
    if (!tables.empty()) effects.push_back(make_effect(info, state, tables));
  }
  return effects;
}

}  // namespace deforma
