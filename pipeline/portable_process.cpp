#include "pipeline/portable_process.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace deforma {

void compute_portably() {
#ifdef __GLIBC__
  constexpr const char* variable = "GLIBC_TUNABLES";
  constexpr std::string_view plain = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2";
  const char* const present = std::getenv(variable);
  const std::string before = present ? present : "";
  if (before.find(plain) != before.npos) return;
  setenv(variable, (before.empty() ? std::string(plain) : before + ":" + std::string(plain)).c_str(), 1);

  std::vector<std::string> arguments;
  std::ifstream line("/proc/self/cmdline", std::ios::binary);
  for (std::string argument; std::getline(line, argument, '\0');) arguments.push_back(argument);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  if (!arguments.empty()) execv("/proc/self/exe", pointers.data());
  throw std::runtime_error("portable: the program could not be started again: " +
                           std::generic_category().message(errno));
#endif
}

}  // namespace deforma
