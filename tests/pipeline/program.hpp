#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace deforma {

/// What a run of the program left: its exit code and all it said.
struct Said {
  int code;
  std::string text;
};

/// Runs a line of the shell, without any display variable.
inline Said shell(const std::string& line) {
  std::string command = "unset DISPLAY WAYLAND_DISPLAY; exec 2>&1; " + line;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("no shell");
  Said said{0, {}};
  std::array<char, 4096> buffer;
  while (std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    said.text.append(buffer.data(), count);
  int status = pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return said;
}

/// Runs the built program through the shell, as a user would.
inline Said deforma_program(const std::string& arguments) { return shell(DEFORMA_PROGRAM " " + arguments); }

}  // namespace deforma
