#include "tests/pipeline/program.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipeline/files.hpp"
#include "render/video.hpp"
#include "sim/effects/registry.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

std::string run_line(const fs::path& scene, const fs::path& folder, const std::string& more = "") {
  return "run " + scene.string() + " -o " + folder.string() + " " + more;
}

TEST(Program, HelpAndVersionEverywhere) {
  for (const char* command : {"", "run", "figure", "check", "effects", "mesh", "new", "bench", "doctor"}) {
    Said help = deforma_program(std::string(command) + " --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.text, HasSubstr("Usage:"));
    Said version = deforma_program(std::string(command) + " --version");
    EXPECT_EQ(version.code, 0);
    EXPECT_THAT(version.text, testing::StartsWith("deforma "));
  }
}

TEST(Program, UnknownArgumentsAreToldWithTheNearest) {
  Said option = deforma_program("run x.toml --overwrit");
  EXPECT_EQ(option.code, 2);
  EXPECT_THAT(option.text, HasSubstr("unknown argument '--overwrit'; did you mean '--overwrite'?"));
  Said command = deforma_program("runn x.toml");
  EXPECT_EQ(command.code, 2);
  EXPECT_THAT(command.text, HasSubstr("did you mean 'run'?"));
  EXPECT_EQ(deforma_program("").code, 2);
  EXPECT_EQ(deforma_program("run").code, 2);
  EXPECT_EQ(deforma_program("run a.toml --threads 0").code, 2);
}

TEST(Program, DrawsOrSaysWhyNotInAnyEnvironment) {
  Scratch scratch;
  const fs::path scene = scratch.write("scene.toml", small_scene());
  fs::create_directory(scratch / "empty");
  auto draw = [&](const std::string& environment) {
    return shell("env " + environment + " " DEFORMA_PROGRAM " " +
                 run_line(scene, scratch / "out", "--frames 1:1 --size 96x64 --no-video --overwrite"));
  };
  const std::string empty = (scratch / "empty").string();
  for (const std::string& environment :
       {std::string("-u HOME -u XDG_RUNTIME_DIR"),
        std::string("XDG_RUNTIME_DIR=/nonexistent HOME=/nonexistent"),
        std::string("DISPLAY=:4711 WAYLAND_DISPLAY=nobody"), std::string("EGL_PLATFORM=x11 DISPLAY=:4711"),
        std::string("LP_NATIVE_VECTOR_WIDTH=512")}) {
    Said said = draw(environment);
    EXPECT_EQ(said.code, 0) << environment << "\n" << said.text;
    EXPECT_TRUE(fs::exists(scratch / "out/frames/0001.png")) << environment;
  }
  for (const std::string& environment :
       {std::string("__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent"), "__EGL_VENDOR_LIBRARY_DIRS=" + empty,
        std::string("MESA_GL_VERSION_OVERRIDE=3.0"), std::string("MESA_GL_VERSION_OVERRIDE=2.1"),
        "LIBGL_DRIVERS_PATH=" + empty}) {
    Said said = draw(environment);
    EXPECT_EQ(said.code, 1) << environment << "\n" << said.text;
    EXPECT_THAT(said.text,
                AllOf(HasSubstr("error: no OpenGL context can be had; tried\n  device"), HasSubstr("EGL_"),
                      HasSubstr("\n  surfaceless: "), HasSubstr("\n  default: "),
                      HasSubstr("without these it may work:\n  " + environment)));
  }
}

/// As when a render node may not be read: the card is listed, and cannot be opened.
TEST(Program, ACardThatCannotBeOpenedIsPassedOverWithAWarning) {
  Scratch scratch;
  const fs::path scene = scratch.write("scene.toml", small_scene());
  const fs::path vendor = scratch.write(
      "card.json",
      "{\"file_format_version\": \"1.0.0\", \"ICD\": {\"library_path\": \"" DEFORMA_BROKEN_CARD "\"}}");
  const fs::path mesa = "/usr/share/glvnd/egl_vendor.d/50_mesa.json";
  if (!fs::exists(mesa)) GTEST_SKIP() << "Mesa is installed elsewhere";
  auto with = [&](const std::string& vendors, const std::string& arguments) {
    return shell("env __EGL_VENDOR_LIBRARY_FILENAMES=" + vendors + " " DEFORMA_PROGRAM " " + arguments);
  };
  const std::string line = run_line(scene, scratch / "out", "--frames 1:1 --size 96x64 --no-video");
  Said both = with(vendor.string() + ":" + mesa.string(), line);
  EXPECT_EQ(both.code, 0) << both.text;
  EXPECT_THAT(both.text,
              HasSubstr("warning: cannot draw on device:0 (/dev/dri/card9): eglInitialize failed with "
                        "EGL_NOT_INITIALIZED; 'device:1' draws on "));
  EXPECT_THAT(read_text_file(scratch / "out/report.json"), HasSubstr("device:0 (/dev/dri/card9)"));

  Said alone = with(vendor.string(), line + " --overwrite");
  EXPECT_EQ(alone.code, 1);
  EXPECT_THAT(alone.text, AllOf(HasSubstr("error: no OpenGL context can be had"), HasSubstr("device:0"),
                                HasSubstr("surfaceless: ")));
  EXPECT_EQ(with(vendor.string() + ":" + mesa.string(), line + " --overwrite --platform device:0").code, 1);
}

TEST(Program, DoctorSaysWhatThereIs) {
  Said said = deforma_program("doctor");
  EXPECT_EQ(said.code, 0) << said.text;
  for (const char* word :
       {"Eigen 3", "assimp ", "libpng ", "libavcodec ", "processor ", "surfaceless: ", "mp4: libx264",
        "webm: libvpx-vp9", "A frame was drawn on ", "A video was written: libx264, yuv420p"})
    EXPECT_THAT(said.text, HasSubstr(word));

  const nlohmann::json found = nlohmann::json::parse(deforma_program("doctor --json").text);
  EXPECT_TRUE(found["healthy"].get<bool>());
  EXPECT_THAT(found["processor"]["instructions"].get<std::vector<std::string>>(),
              testing::Contains(found["processor"]["used"].get<std::string>()));
  EXPECT_THAT(found["frame"]["version"].get<std::string>(), HasSubstr("."));
  for (const auto& [container, codecs] : found["encoders"].items()) EXPECT_FALSE(codecs.empty()) << container;

  const std::string blind = "env __EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent " DEFORMA_PROGRAM " doctor";
  Said none = shell(blind);
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.text,
              AllOf(HasSubstr("no: surfaceless: "), HasSubstr("No frame can be drawn: no OpenGL context"),
                    HasSubstr("A video was written: libx264")));
  EXPECT_FALSE(nlohmann::json::parse(shell(blind + " --json").text)["healthy"].get<bool>());
  Said unknown = deforma_program("doctor --platform windows");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.text, HasSubstr("unknown rendering platform 'windows'"));
}

TEST(Program, RefusesAnEncodingByNameWithTheNearest) {
  Scratch scratch;
  const fs::path scene = scratch.write("scene.toml", small_scene());
  auto refuses = [&](const std::string& options, const std::string& message) {
    Said said = deforma_program(run_line(scene, scratch / "out", options));
    EXPECT_EQ(said.code, 2) << options;
    EXPECT_THAT(said.text, HasSubstr(message));
    EXPECT_FALSE(fs::exists(scratch / "out"));
  };
  refuses("--codec libx246",
          "--codec libx246: output.codec: 'libx246' is no encoder for a video in mp4 (allowed: libx264");
  refuses("--codec libx246", "did you mean 'libx264'?");
  refuses("--preset veryfat",
          "output.preset: 'veryfat' is no preset of libx264 (allowed: ultrafast, superfast, ");
  refuses("--preset veryfat", "did you mean 'veryfast'?");
  refuses("--pix-fmt yuv420", "output.pix_fmt: 'yuv420' is no pixel format of libx264 (allowed: yuv420p, ");
  refuses("--crf 60", "--crf 60: output.crf: the crf of libx264 is from 0 to 51, not 60");
  refuses("--crf good", "--crf good: output.crf: expected");
  refuses("--video webm --preset fast", "output.preset: the codec libvpx-vp9 has no presets; leave it out");
  refuses("--video avi", "--video avi: output.video: unknown choice 'avi'");
  refuses("--transparent --video mp4",
          "--video mp4: output.video: 'mp4' carries no transparency (allowed: mov, mkv, webm)");
  refuses("--transparent --codec libx264",
          "output.codec: 'libx264' carries no transparency in mov (allowed: prores_ks, ");
  refuses("--set output.codec=ffv1",
          "--set output.codec=ffv1: output.codec: 'ffv1' is no encoder for a video in mp4");
}

TEST(Program, EffectsListsTheWholeRegistry) {
  Said said = deforma_program("effects");
  EXPECT_EQ(said.code, 0);
  for (const EffectInfo& info : effect_registry()) {
    EXPECT_THAT(said.text, HasSubstr(fmt::format("\n{}: {}", info.name, info.summary)));
    for (const Setting& setting : info.settings)
      EXPECT_THAT(said.text, HasSubstr(std::string(setting.meaning)));
  }
}

TEST(Program, MeshSaysWhatAFileHolds) {
  Scratch scratch;
  Said said = deforma_program("mesh " + scratch.write("tetra.obj", tetrahedron).string());
  EXPECT_EQ(said.code, 0);
  EXPECT_THAT(said.text,
              AllOf(HasSubstr("triangles            4"), HasSubstr("boundary edges       0 (closed)"),
                    HasSubstr("volume               0.166667 m3"), HasSubstr("components           1")));
  Said missing = deforma_program("mesh " + (scratch / "tetr.obj").string());
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.text, HasSubstr("did you mean 'tetra.obj'?"));
}

TEST(Program, CheckSaysWhatRunningTakes) {
  Scratch scratch;
  Said said = deforma_program("check " + scratch.write("scene.toml", small_scene()).string());
  EXPECT_EQ(said.code, 0) << said.text;
  for (const char* word : {"box", "particles", "neighbours", "time step", "substeps", "memory",
                           "expected time", "elastic, hourglass", "ground"})
    EXPECT_THAT(said.text, HasSubstr(word));
}

TEST(Program, CheckWarnsOfABodyThatNothingStops) {
  Scratch scratch;
  std::string text = small_scene();
  text.replace(text.find("contact = true"), 14, "contact = false");
  Said said = deforma_program("check " + scratch.write("scene.toml", text).string());
  EXPECT_THAT(said.text, HasSubstr("warning: box: falls through every obstacle: it has no 'contact'"));
}

TEST(Program, BodiesThatTouchMustNotBeginDeepInsideSomething) {
  Scratch scratch;
  const std::string other =
      "[[body]]\nname = \"other\"\nshape = { type = \"box\", size = [0.4, 0.4, 0.4] }\nposition = [0.2, 0, "
      "0.5]\n"
      "particles = 64\n";
  const std::string ball =
      "[[obstacle]]\nname = \"ball\"\nshape = { type = \"sphere\", radius = 0.2 }\nposition = [0, 0, 0.8]\n";
  auto check = [&](const std::string& more) {
    return deforma_program("check " + scratch.write("scene.toml", small_scene("", more)).string());
  };
  Said bodies = check(other + "contact = true\n");
  EXPECT_EQ(bodies.code, 2);
  EXPECT_THAT(bodies.text, HasSubstr("of its 64 particles inside 'box': contact would throw them apart"));
  EXPECT_THAT(bodies.text, HasSubstr("scene.toml:"));
  Said obstacle = check(ball);
  EXPECT_EQ(obstacle.code, 2);
  EXPECT_THAT(obstacle.text, HasSubstr("begins 0.1 m deep inside the solid part of 'ball'"));
  // What feels nothing is not thrown: a warning is enough.
  Said unfelt = check(other);
  EXPECT_EQ(unfelt.code, 0) << unfelt.text;
  EXPECT_THAT(unfelt.text, HasSubstr("inside 'other'"));
}

TEST(Program, WarnsOfABodyThatEndsInsideOut) {
  Scratch scratch;
  // Half of the body is pulled through the other half.
  const std::string pins =
      "gravity = false\npin = [ { region = { max = [0, inf, inf] } },"
      " { region = { min = [0, -inf, -inf] }, move = [[0, [0, 0, 0]], [0.1, [-0.6, 0, 0]]] } ]";
  Said said = deforma_program(
      run_line(scratch.write("scene.toml", small_scene(pins)), scratch / "out", "--size 64x64 --no-video"));
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_THAT(said.text, HasSubstr("particles turned inside out"));
}

TEST(Program, TheStarterSceneChecksAndRuns) {
  Scratch scratch;
  scratch.write("tetra.obj", tetrahedron);
  fs::path plain = scratch / "plain.toml", fitted = scratch / "sub/fitted.toml";
  fs::create_directories(scratch / "sub");
  EXPECT_EQ(deforma_program("new -o " + plain.string()).code, 0);
  EXPECT_EQ(deforma_program("new --from " + (scratch / "tetra.obj").string() + " -o " + fitted.string()).code,
            0);
  EXPECT_THAT(read_text_file(fitted), HasSubstr("mesh = \"../tetra.obj\""));
  for (const fs::path& scene : {plain, fitted}) {
    Said check = deforma_program("check " + scene.string());
    EXPECT_EQ(check.code, 0) << check.text;
    EXPECT_THAT(check.text, testing::Not(HasSubstr("warning")));
    Said run =
        deforma_program(run_line(scene, scratch / scene.stem(), "--frames 1:3 --size 160x120 --quiet"));
    EXPECT_EQ(run.code, 0) << run.text;
    EXPECT_EQ(run.text, "");
    EXPECT_TRUE(fs::exists(scratch / scene.stem() / "frames/0003.png"));
  }
  EXPECT_EQ(deforma_program("new").code, 0);
  Said again = deforma_program("new -o " + plain.string());
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.text, HasSubstr("exists"));
}

TEST(Program, RunTakesItsOptions) {
  Scratch scratch;
  fs::path scene = scratch.write("scene.toml", small_scene());
  Said said = deforma_program(run_line(scene, scratch / "out",
                                       "--frames 2:3 --size 200x100 --no-video --threads 1 --view both "
                                       "--set body.0.density=500 --set 'world.gravity=[0,0,-1]'"));
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_FALSE(fs::exists(scratch / "out/video.mp4"));
  EXPECT_FALSE(fs::exists(scratch / "out/frames/0001.png"));
  EXPECT_EQ(read_png(scratch / "out/frames/0003.png").width, 200);
  std::string resolved = read_text_file(scratch / "out/scene.toml");
  EXPECT_THAT(resolved,
              AllOf(HasSubstr("density = 500"), HasSubstr("[0.0, 0.0, -1.0]"), HasSubstr("view = \"both\"")));
}

TEST(Program, AnExistingFolderIsRefusedUnlessToldToOverwrite) {
  Scratch scratch;
  fs::path scene = scratch.write("scene.toml", small_scene());
  ASSERT_EQ(deforma_program(run_line(scene, scratch / "out", "--quiet")).code, 0);
  std::ofstream(scratch / "out/notes.txt") << "mine";
  std::ofstream(scratch / "out/frames/mine.png") << "mine";
  Said refused = deforma_program(run_line(scene, scratch / "out"));
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.text, AllOf(HasSubstr("exists and is not empty"), HasSubstr("--overwrite")));
  EXPECT_TRUE(fs::exists(scratch / "out/frames/0010.png"));
  EXPECT_EQ(deforma_program(run_line(scene, scratch / "out", "--overwrite --frames 1:2 --quiet")).code, 0);
  EXPECT_FALSE(fs::exists(scratch / "out/frames/0010.png"));
  EXPECT_TRUE(fs::exists(scratch / "out/frames/0002.png"));
  EXPECT_EQ(read_text_file(scratch / "out/notes.txt"), "mine");
  EXPECT_EQ(read_text_file(scratch / "out/frames/mine.png"), "mine");
  EXPECT_EQ(inspect_video(scratch / "out/video.mp4").frames, 2u);
}

TEST(Program, OverwritingRemovesWhatAKilledRunLeftAndNothingOfTheUsers) {
  Scratch scratch;
  fs::path scene = scratch.write("scene.toml", small_scene());
  fs::create_directories(scratch / "out/frames");
  const std::vector<std::string> leftovers = {"frames/.0007.4242.part.png", ".video.4242.part.mp4",
                                              ".report.json.part", "video.webm"};
  const std::vector<std::string> others = {
      "video.txt",           "video.srt",   ".video.part.mp4", "frames/.0007.png", "frames/.a.1.part.png",
      "frames/0001.png.bak", "my video.mp4"};
  for (const auto& names : {leftovers, others})
    for (const std::string& name : names) std::ofstream(scratch / "out" / name) << "old";
  ASSERT_EQ(deforma_program(run_line(scene, scratch / "out", "--overwrite --frames 1:1 --quiet")).code, 0);
  for (const std::string& name : leftovers) EXPECT_FALSE(fs::exists(scratch / "out" / name)) << name;
  for (const std::string& name : others) EXPECT_EQ(read_text_file(scratch / "out" / name), "old") << name;
}

TEST(Program, MistakesEndWithTwoOneMessageAndNothingLeft) {
  Scratch scratch;
  fs::path good = scratch.write("good.toml", small_scene());
  scratch.write("text.obj", "this is no mesh\n");
  scratch.write("blocked", "a file where a folder should be");
  std::string body_of_text = "duration = 1\n[[body]]\nmesh = \"text.obj\"\nparticles = 10\n";
  std::string flat = "duration = 1\n[[body]]\nmesh = \"flat.obj\"\nparticles = 10\n";
  scratch.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::string many = small_scene();
  many.replace(many.find("particles = 64"), 14, "particles = 1000000000");
  struct Mistake {
    std::string line, message;
  };
  fs::path out = scratch / "deep/out";
  const std::vector<Mistake> mistakes = {
      {run_line(scratch.write("typo.toml", small_scene("elastic = { youngs = 1 }")), out),
       "did you mean 'young'?"},
      {run_line(scratch.write("nu.toml", small_scene("elastic = { young = 1e5, poisson = 0.5 }")), out),
       "0.5 is outside (-1, 0.5)"},
      {run_line(scratch.write("gone.toml", "duration = 1\n[[body]]\nmesh = \"txt.obj\"\nparticles = 10\n"),
                out),
       "gone.toml:3: body.mesh: no such file 'txt.obj'"},
      {run_line(scratch.write("nomesh.toml", body_of_text), out), "nomesh.toml:3: body.mesh: "},
      {run_line(scratch.write("flat.toml", flat), out), "flat.toml:2: body: "},
      {run_line(scratch.write("many.toml", many), out), "many.toml:7: body: "},
      {run_line(scratch / "god.toml", out), "did you mean 'good.toml'?"},
      {run_line(good, scratch / "blocked/out"), "blocked is no folder"},
      {run_line(good, "/proc/deforma/out"), "/proc"},
      {run_line(good, out, "--frames 0:3"), "outside the scene's frames 1:10"},
      {run_line(good, out, "--frames 3:99"), "outside the scene's frames 1:10"},
      {run_line(good, out, "--frames a:b"), "expected A:B"},
      {run_line(good, out, "--size 640"), "expected WxH"},
      {run_line(good, out, "--size 0x9"), "--size 0x9: output.size: 0 pixels is outside"},
      {run_line(good, out, "--quality nice"), "--quality nice: output.quality: unknown choice 'nice'"},
      {run_line(good, out, "--view solid"), "--view solid: output.view: unknown choice 'solid'"},
      {run_line(good, out, "--platform windows"), "windows"},
      {run_line(good, out, "--set body.0.densty=3"), "unknown key 'densty'; did you mean 'density'?"},
      {run_line(good, out, "--set 'camera.position=[0,0,5]' --set 'camera.target=[0,0,0]'"),
       "along its up direction"},
  };
  for (const Mistake& mistake : mistakes) {
    Said said = deforma_program(mistake.line);
    EXPECT_EQ(said.code, 2) << mistake.line << "\n" << said.text;
    EXPECT_THAT(said.text, AllOf(testing::StartsWith("error: "), HasSubstr(mistake.message))) << mistake.line;
    EXPECT_EQ(std::count(said.text.begin(), said.text.end(), '\n'), 1) << said.text;
    EXPECT_FALSE(fs::exists(scratch / "deep")) << mistake.line;
  }
}

TEST(Program, CheckOfADivergingSceneEndsWithThree) {
  Scratch scratch;
  std::string text = small_scene("load = { force = [0, 0, 1e12], region = { min = [-9, -9, 0.6] } }");
  Said said = deforma_program("check " + scratch.write("scene.toml", text).string());
  EXPECT_EQ(said.code, 3) << said.text;
  EXPECT_THAT(said.text, HasSubstr("error: "));
}

TEST(Program, ADivergedRunKeepsItsGoodFrames) {
  Scratch scratch;
  // From the fourth frame on a force that nothing withstands pulls at one end.
  std::string text = small_scene(
      "load = { force = [[0, [0, 0, 0]], [0.1, [0, 0, 0]], [0.11, [0, 0, 1e12]]], region = { min = [-9, -9, "
      "0.6] } }");
  text.replace(text.find("contact = true"), 14, "contact = false");
  Said said = deforma_program(run_line(scratch.write("scene.toml", text), scratch / "out"));
  EXPECT_EQ(said.code, 3) << said.text;
  EXPECT_THAT(said.text, AllOf(HasSubstr("error: "), HasSubstr("frames before that are kept")));
  EXPECT_TRUE(fs::exists(scratch / "out/frames/0001.png"));
  EXPECT_FALSE(fs::exists(scratch / "out/frames/0010.png"));
  std::size_t pictures = 0;
  for (const auto& entry : fs::directory_iterator(scratch / "out/frames"))
    pictures += entry.is_regular_file();
  EXPECT_EQ(inspect_video(scratch / "out/video.mp4").frames, pictures);
  EXPECT_THAT(read_text_file(scratch / "out/report.json"), HasSubstr("\"diverged\""));
}

TEST(Program, ThreadsDoNotChangeThePictures) {
  Scratch scratch;
  fs::path scene = scratch.write("scene.toml", small_scene());
  for (std::string threads : {"1", "2"})
    ASSERT_EQ(deforma_program(run_line(scene, scratch / threads,
                                       "--quiet --set body.0.particles=2000 --threads " + threads))
                  .code,
              0);
  EXPECT_EQ(read_text_file(scratch / "1/frames/0010.png"), read_text_file(scratch / "2/frames/0010.png"));
}

TEST(Program, PortableIsAnOptionAndAKeyAndIsRemembered) {
  Scratch scratch;
  fs::path scene = scratch.write("scene.toml", small_scene());
  ASSERT_EQ(deforma_program(run_line(scene, scratch / "option", "--quiet --portable")).code, 0);
  ASSERT_EQ(deforma_program(run_line(scene, scratch / "key", "--quiet --set solver.portable=true")).code, 0);
  EXPECT_THAT(read_text_file(scratch / "option/scene.toml"), testing::HasSubstr("portable = true"));
  EXPECT_EQ(read_text_file(scratch / "option/scene.toml"), read_text_file(scratch / "key/scene.toml"));
  EXPECT_EQ(read_text_file(scratch / "option/frames/0010.png"),
            read_text_file(scratch / "key/frames/0010.png"));
}

class Interrupted : public testing::TestWithParam<int> {};

TEST_P(Interrupted, LeavesAValidVideo) {
  Scratch scratch;
  fs::path scene = scratch.write("scene.toml", small_scene());
  fs::path out = scratch / "out";
  pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    execl(DEFORMA_PROGRAM, DEFORMA_PROGRAM, "run", scene.c_str(), "-o", out.c_str(), "--set", "duration=400",
          "--quiet", static_cast<char*>(nullptr));
    _exit(127);
  }
  auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!fs::exists(out / "frames/0003.png") && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  kill(child, GetParam());
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + GetParam());
  std::size_t pictures = 0;
  for (const auto& entry : fs::directory_iterator(out / "frames"))
    pictures += entry.path().extension() == ".png";
  EXPECT_GE(pictures, 3u);
  EXPECT_LT(pictures, 10000u);
  EXPECT_EQ(inspect_video(out / "video.mp4").frames, pictures);
  EXPECT_THAT(read_text_file(out / "report.json"), HasSubstr("\"interrupted\""));
}

INSTANTIATE_TEST_SUITE_P(Program, Interrupted, testing::Values(SIGINT, SIGTERM),
                         [](const auto& info) { return info.param == SIGINT ? "Int" : "Term"; });

}  // namespace
}  // namespace deforma
