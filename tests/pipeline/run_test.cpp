#include "pipeline/run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/files.hpp"
#include "pipeline/user_error.hpp"
#include "render/image.hpp"
#include "render/sha256.hpp"
#include "render/video.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

RunRecord run_text(const Scratch& scratch, const std::string& text, const std::string& folder = "out",
                   std::optional<FrameRange> frames = std::nullopt) {
  RunOptions options;
  options.folder = scratch / folder;
  options.frames = frames;
  return run_scene(load_scene(scratch.write("scene.toml", text)), options);
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::size_t differing_pixels(const Image& a, const Image& b) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < a.rgba.size(); p += 4)
    if (!std::equal(a.rgba.begin() + p, a.rgba.begin() + p + 3, b.rgba.begin() + p)) ++count;
  return count;
}

std::size_t colors_in(const Image& image) {
  std::set<std::uint32_t> colors;
  for (std::size_t p = 0; p < image.rgba.size(); p += 4)
    colors.insert(image.rgba[p] | image.rgba[p + 1] << 8 | image.rgba[p + 2] << 16);
  return colors.size();
}

TEST(Run, WritesFramesVideoReportAndScene) {
  Scratch scratch;
  RunRecord record = run_text(scratch, small_scene());
  EXPECT_EQ(record.ending, Ending::complete);
  EXPECT_EQ(record.frames_written, 10);
  EXPECT_THAT(names_in(scratch / "out"),
              testing::ElementsAre("frames", "report.json", "scene.toml", "video.mp4"));
  ASSERT_EQ(names_in(scratch / "out/frames").size(), 10u);

  VideoFacts video = inspect_video(scratch / "out/video.mp4");
  EXPECT_EQ(video.frames, 10u);
  EXPECT_EQ(video.width, 320);
  EXPECT_EQ(video.height, 240);
  EXPECT_NEAR(video.duration, 0.4, 0.005);
  EXPECT_EQ(video.codec, "h264");
  EXPECT_EQ(video.pixel_format, "yuv420p");

  Image first = read_png(scratch / "out/frames/0001.png");
  Image last = read_png(scratch / "out/frames/0010.png");
  EXPECT_EQ(first.width, 320);
  EXPECT_EQ(first.height, 240);
  EXPECT_GT(colors_in(first), 50u);
  EXPECT_GT(differing_pixels(first, last), 300u);
}

TEST(Run, EncodesAsTheSceneSays) {
  Scratch scratch;
  std::string text = small_scene();
  text.insert(text.find("size ="), "video = \"mkv\"\ncodec = \"ffv1\"\npix_fmt = \"bgra\"\n");
  run_text(scratch, text, "lossless", FrameRange{1, 3});
  VideoFacts video = inspect_video(scratch / "lossless/video.mkv");
  EXPECT_EQ(video.codec, "ffv1");
  EXPECT_EQ(video.pixel_format, "bgra");
  EXPECT_EQ(video.frames, 3u);

  text = small_scene();
  text.insert(text.find("size ="), "video = \"gif\"\n");
  run_text(scratch, text, "gif", FrameRange{1, 3});
  EXPECT_EQ(inspect_video(scratch / "gif/video.gif").codec, "gif");
  const std::string scene = read_text_file(scratch / "gif/scene.toml");
  EXPECT_THAT(scene, HasSubstr("codec = \"gif\""));
  EXPECT_THAT(scene, testing::Not(HasSubstr("crf"))) << "which that codec does not have";
}

TEST(Run, TransparentFramesAndVideoHaveAlpha) {
  Scratch scratch;
  std::string text = small_scene();
  text.insert(text.find("size ="), "transparent = true\n");
  run_text(scratch, text, "out", FrameRange{1, 2});
  const Image frame = read_png(scratch / "out/frames/0001.png");
  EXPECT_EQ(frame.rgba[3], 0) << "the corner";
  std::size_t covered = 0;
  for (std::size_t alpha = 3; alpha < frame.rgba.size(); alpha += 4) covered += frame.rgba[alpha] == 255;
  EXPECT_GT(covered, 100u);
  const VideoFacts video = inspect_video(scratch / "out/video.mov");
  EXPECT_EQ(video.codec, "prores");
  EXPECT_THAT(video.pixel_format, testing::StartsWith("yuva444p"));
}

TEST(Run, EveryFrameSaysWhatItShows) {
  Scratch scratch;
  run_text(scratch, "name = \"falls\"\n" + small_scene(), "first", FrameRange{3, 4});
  run_text(scratch, "name = \"falls\"\n" + small_scene(), "second", FrameRange{4, 4});
  const std::string frame = read_text_file(scratch / "first/frames/0004.png");
  EXPECT_EQ(frame, read_text_file(scratch / "second/frames/0004.png"))
      << "nothing of it depends on when it ran";
  auto holds = [&](const std::string& key, const std::string& value) {
    EXPECT_THAT(frame, HasSubstr(std::string("tEXt") + key + '\0' + value));
  };
  holds("Title", "falls");
  holds("Software", version_text());
  holds("Frame", "4");
  holds("Time", "0.12 s");
  holds("Scene-SHA256", sha256(read_text_file(scratch / "first/scene.toml")));
}

TEST(Run, TheResolvedSceneGivesTheSamePictures) {
  Scratch scratch;
  run_text(scratch, small_scene(), "first");
  RunOptions options;
  options.folder = scratch / "second";
  run_scene(load_scene(scratch / "first/scene.toml"), options);
  EXPECT_EQ(read_text_file(scratch / "first/scene.toml"), read_text_file(scratch / "second/scene.toml"));
  EXPECT_EQ(read_text_file(scratch / "first/frames/0010.png"),
            read_text_file(scratch / "second/frames/0010.png"));
}

TEST(Run, TheReportListsWhatRanAndNothingElse) {
  Scratch scratch;
  run_text(scratch, small_scene("name = \"cube\""));
  json report = json::parse(read_text_file(scratch / "out/report.json"));
  std::set<std::string> effects;
  for (const json& effect : report["effects"]) {
    effects.insert(effect["name"]);
    EXPECT_GT(effect["passes"].get<int>(), 0) << effect["name"];
    EXPECT_GE(effect["seconds"].get<double>(), 0.0);
    EXPECT_TRUE(effect["bytes"].is_number_unsigned());
  }
  EXPECT_EQ(effects, (std::set<std::string>{"elastic", "hourglass", "gravity", "contact"}));
  EXPECT_EQ(report["bodies"][0]["name"], "cube");
  EXPECT_EQ(report["bodies"][0]["particles"], 64);
  EXPECT_NEAR(report["bodies"][0]["mass"].get<double>(), 64.0, 1e-6);
  EXPECT_EQ(report["frames"], 10);
  EXPECT_GT(report["time_step"]["substeps"].get<int>(), 9);
  EXPECT_GT(report["paper"]["FPS"].get<double>(), 0.0);
  EXPECT_GT(report["paper"]["TPIS"].get<double>(), 0.0);
  EXPECT_EQ(report["scene"]["duration"], 0.4);
  EXPECT_FALSE(report["renderer"]["renderer"].get<std::string>().empty());
  EXPECT_FALSE(report["libraries"]["assimp"].get<std::string>().empty());
  const json& stages = report["stage_seconds"];
  EXPECT_EQ(stages.size(), 6u) << stages;
  for (const char* stage : {"build", "simulate", "skin", "draw", "png", "video"}) {
    EXPECT_GT(stages[stage]["busy"].get<double>(), 0.0) << stage;
    EXPECT_GE(stages[stage]["wait"].get<double>(), 0.0) << stage;
    // No stage is counted twice, on whatever thread it runs.
    EXPECT_LE(stages[stage]["busy"].get<double>() + stages[stage]["wait"].get<double>(),
              report["seconds"].get<double>())
        << stage;
  }
  const json& passes = report["drawing_seconds_per_frame"];
  double drawing = 0.0;
  for (const char* pass : {"upload", "shadow", "shading", "resolve", "readback"}) {
    EXPECT_GE(passes[pass].get<double>(), 0.0) << pass;
    drawing += passes[pass].get<double>();
  }
  EXPECT_GT(drawing, 0.0);
  EXPECT_LE(10.0 * drawing, stages["draw"]["busy"].get<double>()) << "it is a part of that stage";
  // It fell for 9 frames: m g h has become kinetic energy, or the ground took it.
  EXPECT_EQ(report["ledger"]["first_frame"]["kinetic"], 0.0);
  EXPECT_GT(report["ledger"]["last_frame"]["kinetic"].get<double>(), 0.0);
}

TEST(Run, TheReportSaysHowEdgesWereSmoothed) {
  Scratch scratch;
  std::string text = small_scene();
  text.insert(text.find("size ="), "video = \"none\"\nquality = \"draft\"\n");
  run_text(scratch, text, "draft", FrameRange{1, 1});
  EXPECT_EQ(json::parse(read_text_file(scratch / "draft/report.json"))["renderer"]["antialiasing"], "none");
  text.insert(text.find("size ="), "samples = 4\n");
  run_text(scratch, text, "samples", FrameRange{1, 1});
  EXPECT_EQ(json::parse(read_text_file(scratch / "samples/report.json"))["renderer"]["antialiasing"],
            "4x multisampling")
      << "samples count more than the quality";
}

TEST(Run, TheVideoFollowsTheScene) {
  Scratch scratch;
  std::string text = small_scene();
  text.insert(text.find("size ="), "video = \"mkv\"\nview = \"both\"\n");
  run_text(scratch, text);
  EXPECT_EQ(inspect_video(scratch / "out/video.mkv").frames, 10u);
  std::string silent = small_scene();
  silent.insert(silent.find("size ="), "video = \"none\"\n");
  run_text(scratch, silent, "silent");
  EXPECT_THAT(names_in(scratch / "silent"), testing::ElementsAre("frames", "report.json", "scene.toml"));
}

TEST(Run, EveryViewDrawsSomethingElse) {
  Scratch scratch;
  std::vector<Image> images;
  for (std::string view : {"surface", "particles", "both"}) {
    std::string text = small_scene();
    text.insert(text.find("size ="), "view = \"" + view + "\"\n");
    run_text(scratch, text, view, FrameRange{1, 1});
    images.push_back(read_png(scratch / (view + "/frames/0001.png")));
    EXPECT_GT(colors_in(images.back()), 50u) << view;
  }
  EXPECT_GT(differing_pixels(images[0], images[1]), 300u);
  EXPECT_GT(differing_pixels(images[0], images[2]), 300u);
  EXPECT_GT(differing_pixels(images[1], images[2]), 300u);
}

TEST(Run, FramesAskedForEqualThoseOfTheWholeRun) {
  Scratch scratch;
  run_text(scratch, small_scene(), "all");
  RunRecord part = run_text(scratch, small_scene(), "part", FrameRange{4, 5});
  EXPECT_EQ(part.frames_written, 2);
  EXPECT_THAT(names_in(scratch / "part/frames"), testing::ElementsAre("0004.png", "0005.png"));
  EXPECT_EQ(read_text_file(scratch / "all/frames/0005.png"),
            read_text_file(scratch / "part/frames/0005.png"));
  EXPECT_EQ(inspect_video(scratch / "part/video.mp4").frames, 2u);
}

TEST(Run, AStopRequestKeepsTheFramesSoFar) {
  Scratch scratch;
  RunOptions options;
  options.folder = scratch / "out";
  int asked = 0;
  options.stop_requested = [&] { return ++asked > 4; };
  RunRecord record = run_scene(load_scene(scratch.write("scene.toml", small_scene())), options);
  EXPECT_EQ(record.ending, Ending::interrupted);
  EXPECT_EQ(record.frames_written, 4);
  EXPECT_EQ(inspect_video(scratch / "out/video.mp4").frames, 4u);
  EXPECT_EQ(json::parse(read_text_file(scratch / "out/report.json"))["ending"]["how"], "interrupted");
}

TEST(Run, AFailureWhileWritingEndsEveryThreadAndIsTold) {
  Scratch scratch;
  RunOptions options;
  options.folder = scratch / "out";
  // The folder vanishes under the run, as a full or pulled disk would have it.
  options.stop_requested = [&] {
    fs::remove_all(scratch / "out");
    return false;
  };
  EXPECT_THROW(run_scene(load_scene(scratch.write("scene.toml", small_scene())), options),
               std::runtime_error);
}

TEST(Run, AWrongPlatformLeavesNothing) {
  Scratch scratch;
  RunOptions options;
  options.folder = scratch / "a/b/out";
  options.platform = "windows";
  EXPECT_THROW(run_scene(load_scene(scratch.write("scene.toml", small_scene())), options), UserError);
  options.platform = "device:99";
  EXPECT_THROW(run_scene(load_scene(scratch.write("scene.toml", small_scene())), options),
               std::runtime_error);
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

class ShippedScene : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScene, RunsTenFrames) {
  Scratch scratch;
  Scene scene = load_scene(find_scene(GetParam()), {{"output.size", "[320, 240]", "test"}});
  ASSERT_GE(scene.frames(), 10);
  RunOptions options;
  options.folder = scratch / "out";
  options.frames = FrameRange{1, 10};
  RunRecord record = run_scene(scene, options);
  EXPECT_EQ(record.ending, Ending::complete) << record.ending_message;
  VideoFacts video = inspect_video(scratch / "out/video.mp4");
  EXPECT_EQ(video.frames, 10u);
  EXPECT_EQ(video.width, 320);
  EXPECT_EQ(video.height, 240);
  EXPECT_NEAR(video.duration, 10.0 / scene.fps, 0.01);
  Image first = read_png(scratch / "out/frames/0001.png");
  EXPECT_GT(colors_in(first), 50u);
  EXPECT_GT(differing_pixels(first, read_png(scratch / "out/frames/0010.png")), 100u);
}

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(DEFORMA_SOURCE_DIR) / "assets" / "scenes"))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ShippedScene);
INSTANTIATE_TEST_SUITE_P(All, ShippedScene, testing::ValuesIn(shipped_scenes()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace deforma
