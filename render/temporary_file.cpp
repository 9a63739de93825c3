#include "render/temporary_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <stdexcept>
#include <system_error>
#include <utility>

namespace deforma {

TemporaryFile::TemporaryFile(std::filesystem::path target) : target_(std::move(target)) {
  // Names within a process differ with their target; two writers of one target in one process would be a
  // mistake anyway.
  path_ = target_.parent_path() /
          fmt::format(".{}.{}.part{}", target_.stem().string(), getpid(), target_.extension().string());
}

TemporaryFile::~TemporaryFile() {
  if (path_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void TemporaryFile::rename() {
  std::error_code error;
  std::filesystem::rename(path_, target_, error);
  if (error)
    throw std::runtime_error(fmt::format("cannot write '{}': {}", target_.string(), error.message()));
  path_.clear();
}

}  // namespace deforma
