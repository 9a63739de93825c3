#include "pipeline/snapshot_store.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <system_error>

namespace deforma {

namespace {

template <typename T>
bool write(std::FILE* file, const T* data, std::size_t count) {
  return std::fwrite(data, sizeof(T), count, file) == count;
}

template <typename T>
bool write(std::FILE* file, const std::vector<T>& items) {
  const std::uint64_t count = items.size();
  return write(file, &count, 1) && (items.empty() || write(file, items.data(), items.size()));
}

template <typename T>
bool read(std::FILE* file, std::vector<T>& items) {
  std::uint64_t count = 0;
  if (std::fread(&count, sizeof count, 1, file) != 1) return false;
  items.resize(count);
  return items.empty() || std::fread(items.data(), sizeof(T), items.size(), file) == items.size();
}

}  // namespace

SnapshotStore::SnapshotStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::string name = (folder_ / ".snapshots.XXXXXX").string();
  const int descriptor = mkstemp(name.data());
  if (descriptor < 0) fail(errno);
  unlink(name.c_str());
  file_.reset(fdopen(descriptor, "w+b"));
  if (!file_) fail(errno);
}

void SnapshotStore::push(const Snapshot& snapshot) {
  if (reading_) throw std::logic_error("a snapshot after the first was taken out");
  std::FILE* file = file_.get();
  if (!write(file, &snapshot.frame, 1) || !write(file, &snapshot.time, 1) || !write(file, snapshot.points) ||
      !write(file, snapshot.particles) || !write(file, snapshot.point_values) ||
      !write(file, snapshot.particle_values))
    fail(errno);
}

std::optional<Snapshot> SnapshotStore::pop() {
  std::FILE* file = file_.get();
  if (!reading_ && (std::fflush(file) != 0 || std::fseek(file, 0, SEEK_SET) != 0)) fail(errno);
  reading_ = true;
  Snapshot snapshot;
  if (std::fread(&snapshot.frame, sizeof snapshot.frame, 1, file) != 1) {
    if (std::ferror(file)) fail(errno);
    return std::nullopt;
  }
  if (std::fread(&snapshot.time, sizeof snapshot.time, 1, file) != 1 || !read(file, snapshot.points) ||
      !read(file, snapshot.particles) || !read(file, snapshot.point_values) ||
      !read(file, snapshot.particle_values))
    fail(errno);
  return snapshot;
}

void SnapshotStore::fail(int code) const {
  throw std::runtime_error(fmt::format("{}: the frames cannot be kept until all are simulated: {}",
                                       folder_.string(),
                                       std::generic_category().message(code != 0 ? code : EIO)));
}

}  // namespace deforma
