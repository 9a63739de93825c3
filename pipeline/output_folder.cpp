#include "pipeline/output_folder.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <regex>

#include "pipeline/user_error.hpp"

namespace deforma {

namespace fs = std::filesystem;

namespace {

// What a killed run leaves under a temporary name counts as its own, too.

bool is_own_frame(const std::string& name) {
  static const std::regex own(R"([0-9]+\.png|\.[0-9]+\.[0-9]+\.part\.png)");
  return std::regex_match(name, own);
}

bool is_own_file(const std::string& name) {
  static const std::regex own(
      R"(report\.json|scene\.toml|colorbar\.svg|\.colorbar\.[0-9]+\.part\.svg|\.(report\.json|scene\.toml)\.part|)"
      R"(\.snapshots\.[A-Za-z0-9]{6}|(video|\.video\.[0-9]+\.part)\.(mp4|mkv|mov|webm|gif))");
  return std::regex_match(name, own);
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder, bool overwrite) : folder_(std::move(folder)) {
  std::error_code error;
  fs::path existing = fs::absolute(folder_).lexically_normal();
  if (!existing.has_filename()) existing = existing.parent_path();
  while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
  if (!fs::is_directory(existing, error))
    throw UserError(
        fmt::format("{}: cannot be the output folder: {} is no folder", folder_.string(), existing.string()));
  if (access(existing.c_str(), W_OK | X_OK) != 0)
    throw UserError(fmt::format("{}: cannot be the output folder: {} is not writable", folder_.string(),
                                existing.string()));
  if (!overwrite && fs::exists(folder_, error) && !fs::is_empty(folder_, error))
    throw UserError(fmt::format("{}: exists and is not empty; give another folder with -o, or --overwrite",
                                folder_.string()));
}

OutputFolder::~OutputFolder() {
  if (!created_ || kept_) return;
  remove_own_files();
  std::error_code ignored;  // a folder that somebody else uses by now is not empty and stays
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) fs::remove(*folder, ignored);
}

void OutputFolder::make(const fs::path& folder) {
  std::error_code error;
  if (folder.empty() || fs::is_directory(folder, error)) return;
  make(folder.parent_path());
  if (!fs::create_directory(folder, error) && error)
    throw UserError(
        fmt::format("{}: cannot make the folder {}: {}", folder_.string(), folder.string(), error.message()));
  made_.push_back(folder);
}

void OutputFolder::create() {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  created_ = true;
  remove_own_files();
  make(folder_ / "frames");
}

void OutputFolder::remove_own_files() const {
  std::error_code ignored;
  std::vector<fs::path> ours;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "frames", ignored))
    if (is_own_frame(entry.path().filename().string())) ours.push_back(entry.path());
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored))
    if (is_own_file(entry.path().filename().string()) && entry.is_regular_file(ignored))
      ours.push_back(entry.path());
  for (const fs::path& file : ours) fs::remove(file, ignored);
}

fs::path OutputFolder::frame_file(int frame) const {
  return folder_ / "frames" / fmt::format("{:04}.png", frame);
}

fs::path OutputFolder::video_file(const std::string& extension) const {
  return folder_ / ("video." + extension);
}

void write_text(const fs::path& file, const std::string& text) {
  fs::path temporary = file.parent_path() / fmt::format(".{}.part", file.filename().string());
  errno = 0;
  std::ofstream stream(temporary, std::ios::binary);
  stream << text;
  stream.close();
  std::error_code error(stream ? 0 : errno != 0 ? errno : EIO, std::generic_category());
  if (stream) fs::rename(temporary, file, error);
  if (!stream || error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
  }
}

}  // namespace deforma
