#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace deforma {

/// What the command line asked for; returns the program's exit code.
using Action = std::function<int()>;

// Each adds its command, with options and help, and puts what it does into `action` when it is chosen.
void add_run_command(CLI::App& program, Action& action);
void add_check_command(CLI::App& program, Action& action);
void add_effects_command(CLI::App& program, Action& action);
void add_mesh_command(CLI::App& program, Action& action);
void add_new_command(CLI::App& program, Action& action);

/// Exit codes of the program.
enum ExitCode {
  exit_ok = 0,
  exit_failure = 1,
  exit_user_error = 2,
  exit_diverged = 3,
  exit_interrupted = 130
};

}  // namespace deforma
