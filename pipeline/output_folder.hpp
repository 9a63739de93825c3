#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace deforma {

/// The folder that a run writes to. What it made there it removes again, unless told to keep it.
class OutputFolder {
 public:
  /// Looks, and changes nothing.
  /// @throws UserError when the folder cannot be made or written to, or is not empty and may not be
  /// overwritten.
  OutputFolder(std::filesystem::path folder, bool overwrite);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Makes the folder and its parents, and removes what an earlier run of this program wrote there, nothing
  /// else.
  /// @throws UserError when that fails.
  void create();

  /// From now on the folder stays.
  void keep() { kept_ = true; }

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path frame_file(int frame) const;  ///< frames/0001.png, ...
  std::filesystem::path video_file(const std::string& extension) const;
  std::filesystem::path color_bar_file() const { return folder_ / "colorbar.svg"; }
  std::filesystem::path report_file() const { return folder_ / "report.json"; }
  std::filesystem::path scene_file() const { return folder_ / "scene.toml"; }

 private:
  void make(const std::filesystem::path& folder);
  void remove_own_files() const;

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< outermost first
  bool created_ = false;
  bool kept_ = false;
};

/// Writes a small text file under a temporary name and renames it. @throws std::runtime_error naming the
/// file.
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace deforma
