#include "pipeline/files.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipeline/user_error.hpp"

namespace deforma {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> file_names(const fs::path& folder, std::string_view extension = "") {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.is_regular_file(ignored) && (extension.empty() || entry.path().extension() == extension))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

}  // namespace

fs::path assets_folder() {
  std::error_code error;
  fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    fs::path installed = program.parent_path().parent_path() / "share" / "deforma" / "assets";
    if (fs::is_directory(installed, error)) return installed;
  }
  return DEFORMA_ASSETS_FALLBACK;
}

namespace {

/// A file, or the name of one in a folder of the assets.
fs::path find_text(const std::string& argument, std::string_view kind, const fs::path& shipped) {
  if (is_file(argument)) return argument;
  for (const std::string& name : {argument, argument + ".toml"})
    if (is_file(shipped / name)) return shipped / name;
  std::error_code ignored;
  if (fs::is_directory(argument, ignored))
    throw UserError(fmt::format("{}: is a folder; expected a {} file (.toml)", argument, kind));
  fs::path wanted(argument);
  fs::path folder = wanted.has_parent_path() ? wanted.parent_path() : fs::path(".");
  std::vector<std::string> names = file_names(folder, ".toml");
  std::vector<std::string> shipped_names;
  for (const std::string& name : file_names(shipped, ".toml"))
    shipped_names.push_back(fs::path(name).stem().string());
  names.insert(names.end(), shipped_names.begin(), shipped_names.end());
  throw UserError(fmt::format("{}: no such {} file{} (shipped {}s: {})", argument, kind,
                              did_you_mean(wanted.filename().string(), names), kind,
                              fmt::join(shipped_names, ", ")));
}

}  // namespace

fs::path find_scene(const std::string& argument) {
  return find_text(argument, "scene", assets_folder() / "scenes");
}

fs::path find_figure(const std::string& argument) {
  return find_text(argument, "figure", assets_folder() / "figures");
}

fs::path find_mesh(const std::string& name, const fs::path& scene_file) {
  fs::path beside = scene_file.parent_path() / name;
  if (is_file(beside)) return beside;
  fs::path installed = assets_folder() / "meshes" / name;
  if (is_file(installed)) return installed;
  return {};
}

std::string missing_mesh_message(const std::string& name, const fs::path& scene_file) {
  fs::path wanted = scene_file.parent_path() / name;
  std::error_code ignored;
  if (fs::is_directory(wanted, ignored)) return fmt::format("'{}' is a folder; expected a mesh file", name);
  std::vector<std::string> names = file_names(wanted.parent_path().empty() ? "." : wanted.parent_path());
  std::vector<std::string> installed = file_names(assets_folder() / "meshes");
  names.insert(names.end(), installed.begin(), installed.end());
  return fmt::format("no such file '{}' (looked for {} and among the installed meshes){}", name,
                     wanted.string(), did_you_mean(wanted.filename().string(), names));
}

bool is_installed_mesh(const fs::path& file) {
  std::error_code ignored;
  fs::path meshes = fs::weakly_canonical(assets_folder() / "meshes", ignored);
  return fs::weakly_canonical(file, ignored).parent_path() == meshes;
}

}  // namespace deforma
