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

/// Runs the built program through the shell, as a user would, without any display variable.
inline Said deforma_program(const std::string& arguments) {
  std::string command = "env -u DISPLAY -u WAYLAND_DISPLAY " DEFORMA_PROGRAM " " + arguments + " 2>&1";
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

}  // namespace deforma
