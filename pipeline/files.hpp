#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace deforma {

/// The folder with the shipped scenes and meshes: beside the installed program, else in the source tree.
std::filesystem::path assets_folder();

/// The scene that a command line means: a file, or the name of a shipped scene.
/// @throws UserError with the nearest name.
std::filesystem::path find_scene(const std::string& argument);

/// The same for a figure.
std::filesystem::path find_figure(const std::string& argument);

/// The mesh that a scene means: relative to the scene's folder, or an installed one.
/// @return an empty path when there is none
std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& scene_file);

/// "no such file 'x'" with the nearest file name in the folder where it should be, or among the installed
/// meshes.
std::string missing_mesh_message(const std::string& name, const std::filesystem::path& scene_file);

/// Whether a found mesh is an installed one, which its name alone finds from any scene.
bool is_installed_mesh(const std::filesystem::path& file);

}  // namespace deforma
