#pragma once

#include <filesystem>

namespace deforma {

/// A name beside `target` to write to first, so that a half-written file is never seen under the name that
/// was asked for. What was written is removed at the end of its life unless `rename` has put it into place.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path target);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// Hidden, and different for every process and every file in it; the extension of the target stays.
  const std::filesystem::path& path() const { return path_; }

  /// @throws std::runtime_error naming the target.
  void rename();

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
};

}  // namespace deforma
