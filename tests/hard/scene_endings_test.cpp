#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "render/image.hpp"
#include "render/video.hpp"
#include "tests/hard/refusal.hpp"

namespace deforma {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(HardCase, ExitThreeADivergingRunKeepsEveryGoodFrame) {
  for (std::string gradient : {"linear", "quadratic"})
    for (std::string video : {"mp4", "webm"}) {
      Scratch scratch;
      // From the fourth frame on a force that nothing withstands pulls at one end of the second body.
      const std::string scene =
          "duration = 0.4\nfps = 25\n[output]\nsize = [160, 120]\nvideo = \"" + video +
          "\"\n[solver]\ngradient = \"" + gradient +
          "\"\n"
          "[[body]]\nname = \"calm\"\nshape = { type = \"sphere\", radius = 0.2 }\nparticles = 40\n"
          "[[body]]\nname = \"torn\"\nshape = { type = \"box\", size = [0.4, 0.4, 0.4], resolution = 4 }\n"
          "position = [1, 0, 0]\nparticles = 64\nelastic = { young = 1e5 }\n"
          "load = { force = [[0, [0, 0, 0]], [0.1, [0, 0, 0]], [0.11, [0, 0, 1e13]]], "
          "region = { min = [-9, -9, 0.1] } }\n";
      const fs::path out = scratch / "out";
      Said said =
          deforma_program("run " + scratch.write("scene.toml", scene).string() + " -o " + out.string());
      EXPECT_EQ(said.code, 3) << said.text;
      EXPECT_THAT(said.text, ContainsRegex("error: the simulation [^\n]*t = 0\\.1[0-9]* s"));
      EXPECT_THAT(said.text, ContainsRegex("body 'torn', particle [0-9]+"));
      EXPECT_THAT(said.text, HasSubstr("step_fraction"));
      EXPECT_THAT(said.text, HasSubstr("frames before that are kept"));

      // Frames at 0, 0.04 and 0.08 s were good; that at 0.12 s is not.
      int frames = 0;
      for (const auto& entry : fs::directory_iterator(out / "frames")) {
        EXPECT_EQ(entry.path().extension(), ".png") << entry.path();
        Image image = read_png(entry.path());
        EXPECT_EQ(image.width, 160);
        ++frames;
      }
      EXPECT_EQ(frames, 3);
      EXPECT_TRUE(fs::exists(out / "frames/0003.png"));
      VideoFacts facts = inspect_video(out / ("video." + video));  // decodes every frame
      EXPECT_EQ(facts.frames, 3u);
      EXPECT_NEAR(facts.duration, 3 / 25.0, 1e-3);
      nlohmann::json report = nlohmann::json::parse(read_text_file(out / "report.json"));
      EXPECT_THAT(report.dump(), AllOf(HasSubstr("\"diverged\""), HasSubstr("torn")));
      EXPECT_EQ(load_scene(out / "scene.toml").bodies.size(), 2u);
      for (const auto& entry : fs::recursive_directory_iterator(out))
        EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".part"))) << entry.path();
    }
}

TEST(HardCase, ReversedRegionsAreRefused) {
  Scratch scratch;
  auto scene = [](const std::string& effect) {
    return "duration = 1\n[[body]]\nshape = { type = \"box\", size = [1, 1, 1] }\nparticles = 27\n" + effect +
           "\n";
  };
  for (std::string axis : {"x", "y", "z"}) {
    const int at = axis[0] - 'x';
    std::vector<std::string> low(3, "-1"), high(3, "1");
    low[at] = "0.5";
    high[at] = "-0.25";
    std::string box = fmt::format("min = [{}, {}, {}], max = [{}, {}, {}]", low[0], low[1], low[2], high[0],
                                  high[1], high[2]);
    for (std::string effect : {"pin", "load"})
      expect_run_refused(scratch, scene(effect + " = { region = { " + box + " } }"),
                         {"scene.toml:5: body." + effect + ".region: no " + axis +
                          " is from min = 0.5 up to max = -0.25; expected min <= max"});
  }
}

TEST(HardCase, PlatformsThatAreNotThereAreTheUsersMistake) {
  Scratch scratch;
  expect_run_refused(
      scratch, small_scene(),
      {"there is no rendering platform 'device:77'; EGL lists ", "auto, surfaceless and default"},
      "--platform device:77");
  for (std::string name : {"device:", "device:-1", "windows"})
    expect_run_refused(scratch, small_scene(), {"unknown rendering platform '" + name + "'", "device:N"},
                       "--platform " + name);
}

/// The program with files limited to so many blocks (of 512 bytes, in most shells): writing fails as on a full disk.
Said with_little_room(int blocks, const std::string& arguments) {
  return shell(fmt::format("trap '' XFSZ; ulimit -f {}; " DEFORMA_PROGRAM " {}", blocks, arguments));
}

TEST(HardCase, AFullDiskIsToldByItsCause) {
  struct Case {
    int blocks;
    std::string options, guilty;
    std::size_t frames;  ///< that are finished, and so stay
  };
  const std::vector<Case> cases = {
      {0, "--size 1280x960 --no-video", "scene.toml: cannot be written: ", 0},
      {1, "--size 1280x960", "scene.toml: cannot be written: ", 0},
      {4, "--size 1280x960 --no-video", "frames/0001.png': ", 0},
      {40, "--size 1280x960", "frames/0001.png': ", 0},
      // A frame takes 17 kB, the video 31 kB.
      {46, "--size 160x120 --crf 0 --preset medium", "video.mp4': finishing: ", 10},
  };
  for (const Case& given : cases) {
    Scratch scratch;
    const fs::path scene = scratch.write("scene.toml", small_scene()), out = scratch / "deep/out";
    Said said = with_little_room(
        given.blocks, "run " + scene.string() + " -o " + out.string() + " --quiet " + given.options);
    EXPECT_EQ(said.code, 1) << said.text;
    EXPECT_THAT(said.text, testing::StartsWith("error: "));
    EXPECT_THAT(said.text, HasSubstr(out.string() + "/" + given.guilty + "File too large")) << given.blocks;
    EXPECT_EQ(std::count(said.text.begin(), said.text.end(), '\n'), 1) << said.text;
    // With nothing finished nothing is left.
    EXPECT_EQ(fs::exists(scratch / "deep"), given.frames > 0);
    std::size_t frames = 0;
    if (given.frames > 0)
      for (const auto& entry : fs::recursive_directory_iterator(out)) {
        EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".part")));
        if (entry.path().extension() != ".png") continue;
        EXPECT_EQ(read_png(entry.path()).width, 160);
        ++frames;
      }
    EXPECT_EQ(frames, given.frames);
  }
}

TEST(HardCase, FoldersThatCannotBeWrittenAreToldByTheirCause) {
  Scratch scratch;
  const fs::path scene = scratch.write("scene.toml", small_scene());
  scratch.write("file", "a file where a folder should be");
  const std::vector<std::pair<std::string, std::string>> folders = {
      {"/proc/deforma/out", "cannot"},
      {(scratch / "file").string(), "is no folder"},
      {(scratch / "file/out").string(), "is no folder"},
      {(scratch / std::string(300, 'a')).string(), "File name too long"}};
  for (const auto& [folder, cause] : folders) {
    Said said = deforma_program("run " + scene.string() + " -o " + folder);
    EXPECT_EQ(said.code, 2) << said.text;
    EXPECT_THAT(said.text, AllOf(testing::StartsWith("error: "), HasSubstr(folder), HasSubstr(cause)));
    EXPECT_EQ(std::count(said.text.begin(), said.text.end(), '\n'), 1) << said.text;
  }
}

}  // namespace
}  // namespace deforma
