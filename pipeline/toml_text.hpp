#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>

namespace deforma {

/// Reads a TOML file. @throws UserError naming file and line.
toml::table parse_toml_file(const std::filesystem::path& file);

/// A node as TOML in one line.
std::string to_inline_text(const toml::node& node);

/// A scene's table as TOML: values first, then [tables] and [[lists of tables]], whatever is deeper in one
/// line. Numbers are written with the fewest digits that read back the same.
std::string to_toml_text(const toml::table& table);

/// The same as JSON; what JSON cannot hold (infinity) is written as text.
std::string to_json_text(const toml::table& table);

}  // namespace deforma
