#include "pipeline/toml_text.hpp"

#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pipeline/user_error.hpp"

namespace deforma {

namespace {

std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  // TOML tells a float by its point or exponent; without one it would read back as an integer.
  bool plain = std::isfinite(value) && text.find_first_of(".e") == text.npos;
  return plain ? text + ".0" : text;
}

void append_lines(std::string& text, const toml::table& table) {
  for (const auto& [key, value] : table) text += fmt::format("{} = {}\n", key.str(), to_inline_text(value));
}

bool is_list_of_tables(const toml::node& node) {
  const toml::array* array = node.as_array();
  return array && !array->empty() && array->is_homogeneous(toml::node_type::table);
}

nlohmann::json to_json(const toml::node& node) {
  if (const toml::table* table = node.as_table()) {
    nlohmann::json object = nlohmann::json::object();
    for (const auto& [key, value] : *table) object[std::string(key.str())] = to_json(value);
    return object;
  }
  if (const toml::array* array = node.as_array()) {
    nlohmann::json list = nlohmann::json::array();
    for (const toml::node& element : *array) list.push_back(to_json(element));
    return list;
  }
  if (const toml::value<double>* number = node.as_floating_point()) {
    if (!std::isfinite(number->get())) return fmt::format("{}", number->get());
    return number->get();
  }
  if (const toml::value<std::int64_t>* integer = node.as_integer()) return integer->get();
  if (const toml::value<bool>* flag = node.as_boolean()) return flag->get();
  return node.value_or(std::string());
}

}  // namespace

std::string to_inline_text(const toml::node& node) {
  if (const toml::value<double>* number = node.as_floating_point()) return number_text(number->get());
  if (const toml::value<std::string>* plain = node.as_string())
    if (plain->get().find_first_of("\"\\\n\r\t") == std::string::npos)
      return fmt::format("\"{}\"", plain->get());
  std::string text;
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& element : *array) text += (text.empty() ? "" : ", ") + to_inline_text(element);
    return fmt::format("[{}]", text);
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table)
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key.str(), to_inline_text(value));
    return text.empty() ? "{}" : fmt::format("{{ {} }}", text);
  }
  std::ostringstream stream;
  node.visit([&](const auto& value) { stream << value; });
  return stream.str();
}

std::string to_toml_text(const toml::table& table) {
  std::string text;
  for (const auto& [key, value] : table)
    if (!value.is_table() && !is_list_of_tables(value))
      text += fmt::format("{} = {}\n", key.str(), to_inline_text(value));
  for (const auto& [key, value] : table) {
    if (const toml::table* inner = value.as_table()) {
      text += fmt::format("\n[{}]\n", key.str());
      append_lines(text, *inner);
    }
    if (!is_list_of_tables(value)) continue;
    for (const toml::node& element : *value.as_array()) {
      text += fmt::format("\n[[{}]]\n", key.str());
      append_lines(text, *element.as_table());
    }
  }
  return text;
}

std::string to_json_text(const toml::table& table) { return to_json(table).dump(); }

toml::table parse_toml_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || text.str().empty())
    throw UserError(fmt::format("{}: cannot be read, or is empty", file.string()));
  try {
    return toml::parse(text.str(), file.string());
  } catch (const toml::parse_error& error) {
    throw UserError(fmt::format("{}:{}: not valid TOML: {}", file.string(), error.source().begin.line,
                                error.description()));
  }
}

}  // namespace deforma
