#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/commands.hpp"
#include "pipeline/report.hpp"
#include "pipeline/user_error.hpp"

using namespace deforma;

namespace {

/// What the command line says, and which command it chose. The only file that knows CLI11.
struct CommandLine {
  CLI::App program{"Animations of deforming solids, simulated and rendered without a display", "deforma"};
  RunCommand run_options;
  FigureCommand figure_options;
  SceneOptions check_options;
  std::string mesh;
  NewCommand new_options;
  ValidateCommand validate_options;
  BenchCommand bench_options;
  DoctorCommand doctor_options;
  std::function<int()> action;

  CommandLine() {
    add_run();
    add_figure();
    CLI::App* command = add("check", "Validate a scene and say what running it takes",
                            [this] { return check(check_options); });
    add_scene_options(*command, check_options);
    add("effects", "List every effect with its settings, units, defaults and ranges", print_effects);
    command = add("mesh", "Say what a mesh file holds", [this] { return print_mesh(mesh); });
    command->add_option("file", mesh, "Any format that assimp reads")->required();
    command = add("new", "Write a commented starter scene", [this] { return write_new_scene(new_options); });
    command->add_option("--from", new_options.mesh, "Fit the scene to this mesh")->type_name("MESH");
    command->add_option("-o,--output", new_options.file, "File to write; standard output by default")
        ->type_name("FILE");
    add_validate();
    add_bench();
    command =
        add("doctor", "Say what this machine offers, and whether a frame can be drawn and a video written",
            [this] { return doctor(doctor_options); });
    command->add_flag("--json", doctor_options.json, "Print it as JSON");
    command
        ->add_option("--platform", doctor_options.platform,
                     "Where to draw: auto, device:N, surfaceless or default")
        ->type_name("PLATFORM");
    program.require_subcommand(1);
    program.set_version_flag("--version", version_text());
  }

  CLI::App* add(const std::string& name, const std::string& help, std::function<int()> does) {
    CLI::App* command = program.add_subcommand(name, help);
    command->set_version_flag("--version", version_text());
    command->callback([this, does = std::move(does)] { action = does; });
    return command;
  }

  static void add_scene_options(CLI::App& command, SceneOptions& options) {
    command.add_option("scene", options.scene, "Scene file, or the name of a shipped scene")->required();
    command
        .add_option("--set", options.sets,
                    "Give a key another value, such as body.0.elastic.young=1e5; may be repeated")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command.add_option("--size", options.size, "Size of the pictures in pixels")->type_name("WxH");
    command.add_option("--view", options.view, "What is drawn: surface, particles or both")
        ->type_name("VIEW");
    command
        .add_option("--color-by", options.color_by,
                    "Colour the bodies by a field: displacement, speed, von_mises, principal_stretch, det_f, "
                    "energy_density or none")
        ->type_name("FIELD");
    command.add_option("--color-map", options.color_map, "viridis, cividis, magma, coolwarm or automatic")
        ->type_name("MAP");
    command
        .add_option("--color-range", options.color_range,
                    "Values at the ends of the colour map, in SI units; found over the whole run by default")
        ->type_name("LOW:HIGH");
    command.add_option("--quality", options.quality, "What pictures may cost: draft, standard or final")
        ->type_name("QUALITY");
    command.add_option("--threads", options.threads, "How many threads simulate; all by default")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    command.add_flag("--portable", options.portable,
                     "The same bits of the simulation on any x86-64 processor, a little slower");
  }

  void add_run() {
    RunCommand& options = run_options;
    CLI::App* command = add("run", "Simulate a scene and write its frames, video and report",
                            [this] { return run(run_options); });
    add_scene_options(*command, options.scene);
    command->add_option("-o,--output", options.folder, "Folder to write to; out/NAME by default")
        ->type_name("DIR");
    command->add_option("--frames", options.frames, "Write only these frames, counted from 1")
        ->type_name("A:B");
    command
        ->add_option("--platform", options.platform, "Where to draw: auto, device:N, surfaceless or default")
        ->type_name("PLATFORM");
    command->add_option("--video", options.scene.video, "Kind of video: mp4, mkv, mov, webm, gif or none")
        ->type_name("KIND");
    command
        ->add_option("--codec", options.scene.codec, "Encoder, such as libx264, libx265, libvpx-vp9 or ffv1")
        ->type_name("NAME");
    command->add_option("--preset", options.scene.preset, "Of the encoder: less time or fewer bytes")
        ->type_name("NAME");
    command->add_option("--crf", options.scene.crf, "Quality of the video, lower is better")->type_name("N");
    command->add_option("--pix-fmt", options.scene.pixel_format, "Pixel format of the video, such as yuv444p")
        ->type_name("NAME");
    command->add_flag(
        "--transparent", options.scene.transparent,
        "No floor or background: pictures and video with alpha; mov unless --video says webm or mkv");
    command->add_flag("--no-video", options.no_video, "Write the frames only");
    command->add_flag("--overwrite", options.overwrite,
                      "Replace the frames, video and report of an earlier run");
    command->add_flag("--quiet", options.quiet, "Say nothing but errors");
  }

  void add_figure() {
    FigureCommand& options = figure_options;
    CLI::App* command = add("figure", "Compose frames of scenes to a figure, as PNG, PDF and SVG",
                            [this] { return make_figure(figure_options); });
    command->add_option("figure", options.figure, "Figure file, or the name of a shipped one")->required();
    command->add_option("-o,--output", options.folder, "Folder to write to; out by default")
        ->type_name("DIR");
    command
        ->add_option("--platform", options.platform, "Where to draw: auto, device:N, surfaceless or default")
        ->type_name("PLATFORM");
    command->add_option("--threads", options.threads, "How many threads simulate; all by default")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    command->add_flag("--overwrite", options.overwrite, "Replace the figure's files");
    command->add_flag("--quiet", options.quiet, "Say nothing but errors");
  }

  static void repeated(CLI::Option* option, const char* type) {
    option->type_name(type)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }

  void add_validate() {
    ValidateCommand& options = validate_options;
    CLI::App* command =
        add("validate", "Run experiments whose outcome is known and print how far off they are",
            [this] { return validate(validate_options); });
    command->footer(
        "Each line of the table compares a measured value with its reference. The default settings have a\n"
        "goal and a limit for their error: within the goal is 'ok', beyond it 'missed', beyond the limit\n"
        "'FAILED', and then the exit code is 1. Other settings are shown beside, but never fail. Every case\n"
        "is a scene: see --write.");
    command->add_flag(
        "--quick", options.quick,
        "Only 4 and 6 particles across and, unless --settings says more, the default: a minute");
    repeated(
        command->add_option("--case", options.cases,
                            "Only this case, or all whose names begin so (elastica: elastica-1 ...); may be "
                            "repeated"),
        "NAME");
    repeated(
        command->add_option("--settings", options.settings,
                            "Only these settings: default, the other gradient's name, paper, or all; may be "
                            "repeated"),
        "NAME");
    repeated(command
                 ->add_option("-n,--across", options.sizes,
                              "So many particles across instead of 4, 6, 8 and 10; may be repeated")
                 ->check(CLI::Range(4, 20)),
             "N");
    repeated(command->add_option("--set", options.sets,
                                 "Give a key of every scene another value, such as "
                                 "body.0.hourglass.stiffness=3; may be repeated"),
             "KEY=VALUE");
    command
        ->add_option("-o,--output", options.folder,
                     "Write the table to validation.md and validation.csv there too")
        ->type_name("DIR");
    command
        ->add_option("--write", options.scenes,
                     "Write the scenes of the cases (n = 6) there instead of running them")
        ->type_name("DIR");
    command->add_flag("--list", options.list, "Name the cases instead of running them");
    command->add_flag("--quiet", options.quiet, "Do not tell how far it has come");
    command
        ->add_option("--threads", options.threads,
                     "How many cases run side by side; as many as cores by default")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
  }

  void add_bench() {
    BenchCommand& options = bench_options;
    CLI::App* command = add("bench", "Measure how fast this machine simulates, beside a plain loop",
                            [this] { return bench(bench_options); });
    command->footer(
        "What a plain loop of the same physics does on the same bodies is measured in turn with the "
        "program,\n"
        "and every number is a median, so that ratios hold on a machine that has other work, too.");
    command->add_flag("--quick", options.quick, "Small bodies and short turns: half a minute, but rough");
    repeated(command
                 ->add_option("-n,--particles", options.sizes,
                              "So many particles instead of 300, 1000, 8000, 64000, 1e5 and 1e6 in the table "
                              "of steps; may be repeated")
                 ->check(CLI::Range(64, 100000000)),
             "N");
    repeated(
        command->add_option("--table", options.tables,
                            "Only this table: steps, stages, threads, effects or paper; may be repeated"),
        "NAME");
    command->add_option("--json", options.json, "Write the measurements to this file, too")
        ->type_name("FILE");
    command->add_flag("--quiet", options.quiet, "Do not tell what is being measured");
    command->add_option("--threads", options.threads, "How many threads may be used; all by default")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
  }
};

/// Every name that an unexpected argument may have meant: the options of the chosen command, or the commands.
std::vector<std::string> valid_names(const CLI::App& program) {
  std::vector<std::string> names;
  std::vector<CLI::App*> chosen = program.get_subcommands();
  const CLI::App& app = chosen.empty() ? program : *chosen.front();
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

int explain(const CLI::App& program, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return program.exit(error);  // help and version
  std::vector<std::string> extras = program.remaining(true);
  if (!extras.empty()) {
    std::string name = extras.front().substr(0, extras.front().find('='));
    std::vector<std::string> valid = valid_names(program);
    fmt::print(stderr, "error: unknown argument '{}'{} (allowed: {})\n", extras.front(),
               did_you_mean(name, valid), fmt::join(valid, ", "));
  } else {
    fmt::print(stderr, "error: {}\n", error.what());
  }
  fmt::print(stderr, "See deforma --help.\n");
  return exit_user_error;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line;
  try {
    line.program.parse(argc, argv);
    return line.action();
  } catch (const CLI::ParseError& error) {
    return explain(line.program, error);
  } catch (const UserError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return exit_user_error;
  } catch (const SimulationDiverged& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return exit_diverged;
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return exit_failure;
  }
}
