#pragma once

#include <string>

#include "pipeline/table_reader.hpp"
#include "sim/parameters.hpp"

namespace deforma {

/// Reads the given settings from a table, each by its own type and range; unknown keys and missing ones are
/// told by the reader's `finish`.
Parameters read_settings(TableReader& reader, std::span<const Setting> settings);

/// Reads what the scene says of an effect: a table, `true` for all defaults, or a value for the first
/// setting.
/// @throws UserError with file, line, key, what was found and what is allowed.
Parameters read_parameters(const toml::node& node, std::span<const Setting> settings,
                           const std::string& path);

}  // namespace deforma
