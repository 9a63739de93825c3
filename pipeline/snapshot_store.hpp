#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "pipeline/drawing.hpp"

namespace deforma {

/// Keeps the snapshots of a run until what the drawing needs of all of them is known. They lie in a file without a name,
/// which goes with the process, so that memory does not grow with the number of frames.
class SnapshotStore {
 public:
  /// @param folder where there is room
  /// @throws std::runtime_error naming the folder, as all below.
  explicit SnapshotStore(std::filesystem::path folder);

  void push(const Snapshot& snapshot);

  /// The next in the order in which they came, or none after the last. After the first pop nothing can be pushed.
  std::optional<Snapshot> pop();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  [[noreturn]] void fail(int code) const;

  std::filesystem::path folder_;
  std::unique_ptr<std::FILE, Close> file_;
  bool reading_ = false;
};

}  // namespace deforma
