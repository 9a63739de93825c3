#pragma once

#include <string>
#include <vector>

#include "pipeline/scene_options.hpp"

// The commands of the program, each in a file of its own, with what the command line says to it. Each returns the
// program's exit code and throws UserError for a mistake of the user's.
namespace deforma {

/// `deforma run`: simulates a scene and writes its frames, video and report.
struct RunCommand {
  SceneOptions scene;
  std::string folder;  ///< out/NAME when empty
  std::string frames;  ///< A:B; all when empty
  std::string platform = "auto";
  bool no_video = false;
  bool overwrite = false;
  bool quiet = false;
};
int run(const RunCommand& command);

/// `deforma figure`: composes frames of scenes to a figure, as PNG, PDF and SVG.
struct FigureCommand {
  std::string figure;          ///< file, or the name of a shipped one
  std::string folder = "out";  ///< to write to
  std::string platform = "auto";
  bool overwrite = false;
  bool quiet = false;
  int threads = 0;  ///< 0: all
};
int make_figure(const FigureCommand& command);

/// `deforma check`: validates a scene and says what running it takes.
int check(const SceneOptions& options);

/// `deforma effects`: the table of effects.
int print_effects();

/// `deforma mesh`: what a mesh file holds.
int print_mesh(const std::string& name);

/// `deforma new`: writes a commented starter scene.
struct NewCommand {
  std::string mesh;  ///< to fit the scene to; a built-in shape when empty
  std::string file;  ///< to write; standard output when empty
};
int write_new_scene(const NewCommand& command);

/// `deforma validate`: measures experiments whose outcome is known and holds them against it.
struct ValidateCommand {
  bool quick = false;                 ///< n = 4 and 6 only, and judged settings unless others are given
  std::vector<std::string> cases;     ///< all when empty
  std::vector<std::string> settings;  ///< names; all when empty
  std::vector<int> sizes;             ///< particles across; all when empty
  std::vector<std::string> sets;      ///< KEY=VALUE, for every scene
  std::string folder;                 ///< to write the table to as well; not when empty
  std::string scenes;  ///< to write the cases' scenes to, instead of running them; not when empty
  bool list = false;   ///< names the cases instead of running them
  bool quiet = false;
  int threads = 0;  ///< 0: all
};
int validate(const ValidateCommand& command);

/// `deforma bench`: measures how fast this machine simulates.
struct BenchCommand {
  bool quick = false;               ///< small bodies, short turns, nothing drawn
  std::vector<int> sizes;           ///< particles; usual ones when empty
  std::vector<std::string> tables;  ///< names; all when empty
  std::string json;                 ///< file to write the measurements to as well; not when empty
  bool quiet = false;
  int threads = 0;  ///< 0: all
};
int bench(const BenchCommand& command);

/// `deforma doctor`: says what the program finds on this machine, and tries to draw a frame and to write a video.
/// Returns 0 when both succeed, 1 otherwise.
struct DoctorCommand {
  std::string platform = "auto";  ///< as in ContextRequest
  bool json = false;              ///< prints JSON
};
int doctor(const DoctorCommand& command);

/// Exit codes of the program.
enum ExitCode {
  exit_ok = 0,
  exit_failure = 1,
  exit_user_error = 2,
  exit_diverged = 3,
  exit_interrupted = 130,
  exit_terminated = 143
};

}  // namespace deforma
