#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "pipeline/commands.hpp"
#include "pipeline/report.hpp"
#include "pipeline/user_error.hpp"

namespace {

/// Every name that an unexpected argument may have meant: the options of the chosen command, or the commands.
std::vector<std::string> valid_names(const CLI::App& program) {
  std::vector<std::string> names;
  std::vector<CLI::App*> chosen = program.get_subcommands();
  const CLI::App& app = chosen.empty() ? program : *chosen.front();
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

int explain(const CLI::App& program, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return program.exit(error);  // help and version
  std::vector<std::string> extras = program.remaining(true);
  if (!extras.empty()) {
    std::string name = extras.front().substr(0, extras.front().find('='));
    std::vector<std::string> valid = valid_names(program);
    fmt::print(stderr, "error: unknown argument '{}'{} (allowed: {})\n", extras.front(),
               deforma::did_you_mean(name, valid), fmt::join(valid, ", "));
  } else {
    fmt::print(stderr, "error: {}\n", error.what());
  }
  fmt::print(stderr, "See deforma --help.\n");
  return deforma::exit_user_error;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Animations of deforming solids, simulated and rendered without a display", "deforma");
  deforma::Action action;
  deforma::add_run_command(program, action);
  deforma::add_check_command(program, action);
  deforma::add_effects_command(program, action);
  deforma::add_mesh_command(program, action);
  deforma::add_new_command(program, action);
  program.require_subcommand(1);
  program.set_version_flag("--version", deforma::version_text());
  for (CLI::App* command : program.get_subcommands(nullptr))
    command->set_version_flag("--version", deforma::version_text());
  try {
    program.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    return explain(program, error);
  } catch (const deforma::UserError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return deforma::exit_user_error;
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return deforma::exit_failure;
  }
}
