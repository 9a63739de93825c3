#include "pipeline/coloring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/run.hpp"
#include "pipeline/user_error.hpp"
#include "render/image.hpp"
#include "tests/pipeline/program.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

/// A scene with more in its [output] table.
std::string scene_with(const std::string& output, const std::string& body = "") {
  std::string text = small_scene(body);
  const std::string size = "size = [320, 240]\n";
  return text.replace(text.find(size), size.size(), size + "video = \"none\"\n" + output + "\n");
}

RunRecord run_text(const Scratch& scratch, const std::string& text, const std::string& folder,
                   std::optional<FrameRange> frames = std::nullopt) {
  RunOptions options;
  options.folder = scratch / folder;
  options.frames = frames;
  return run_scene(load_scene(scratch.write(folder + ".toml", text)), options);
}

json report_of(const Scratch& scratch, const std::string& folder) {
  return json::parse(read_text_file(scratch / folder / "report.json"));
}

TEST(Coloring, AnAutomaticRangeIsOneForAllFramesAndIsReported) {
  Scratch scratch;
  run_text(scratch, scene_with("color_by = \"von_mises\""), "open");
  const json color = report_of(scratch, "open")["color"];
  EXPECT_EQ(color["field"], "von_mises");
  EXPECT_EQ(color["unit"], "Pa");
  EXPECT_EQ(color["map"], "viridis");
  EXPECT_TRUE(color["automatic"].get<bool>());
  const double high = color["range"][1], highest = color["highest"];
  EXPECT_EQ(color["range"][0], 0.0);
  EXPECT_GT(highest, 100.0) << "it hit the ground";
  EXPECT_GT(high, 0.1 * highest);

  // Every frame is the one that the range, given from the start, leads to.
  run_text(scratch, scene_with("color_by = \"von_mises\"\ncolor_range = " + color["range"].dump()), "given");
  EXPECT_FALSE(report_of(scratch, "given")["color"]["automatic"].get<bool>());
  EXPECT_EQ(report_of(scratch, "given")["color"]["range"], color["range"]);
  for (const char* frame : {"0001.png", "0005.png", "0010.png"})
    EXPECT_TRUE(read_png(scratch / "open/frames" / frame).rgba ==
                read_png(scratch / "given/frames" / frame).rgba)
        << frame;
}

TEST(Coloring, NothingIsKeptForASceneWithoutIt) {
  Scratch scratch;
  const Scene scene = load_scene(scratch.write("scene.toml", small_scene()));
  World world = build(scene);
  world.solver->advance(0.04);
  const Snapshot snapshot = take_snapshot(scene, *world.solver, 2);
  EXPECT_FALSE(snapshot.points.empty());
  EXPECT_TRUE(snapshot.point_values.empty());
  EXPECT_TRUE(snapshot.particle_values.empty());
  EXPECT_FALSE(Coloring::of(scene));
  EXPECT_FALSE(report_of(scratch, (run_text(scratch, small_scene(), "plain", FrameRange{1, 1}), "plain"))
                   .contains("color"));
}

TEST(Coloring, ParticlesAreColouredWhereTheyAreDrawn) {
  Scratch scratch;
  const Scene scene =
      load_scene(scratch.write("scene.toml", scene_with("color_by = \"speed\"\nview = \"both\"")));
  World world = build(scene);
  world.solver->advance(0.1);  // falls freely
  const Snapshot snapshot = take_snapshot(scene, *world.solver, 2);
  ASSERT_EQ(snapshot.particle_values.size(), 64u);
  ASSERT_EQ(snapshot.point_values.size(), snapshot.points.size());
  for (float speed : snapshot.particle_values) EXPECT_NEAR(speed, 0.981, 1e-4);
  for (float speed : snapshot.point_values) EXPECT_NEAR(speed, 0.981, 1e-4);
}

TEST(Coloring, InvisibleBodiesDoNotCount) {
  Scratch scratch;
  const Scene scene =
      load_scene(scratch.write("scene.toml", scene_with("color_by = \"speed\"", "visible = false")));
  World world = build(scene);
  world.solver->advance(0.1);
  std::optional<Coloring> coloring = Coloring::of(scene);
  ASSERT_TRUE(coloring);
  coloring->add(scene, world.solver->state(), take_snapshot(scene, *world.solver, 2));
  EXPECT_GT(coloring->values.lowest(), coloring->values.highest()) << "no value at all";
}

TEST(Coloring, TheMapSuitsTheFieldUnlessOneIsGiven) {
  Scratch scratch;
  const auto map_of = [&](const std::string& output) {
    return std::string(
        Coloring::of(load_scene(scratch.write("scene.toml", scene_with(output))))->scale.map->name);
  };
  EXPECT_EQ(map_of("color_by = \"speed\""), "viridis");
  EXPECT_EQ(map_of("color_by = \"det_f\""), "coolwarm");
  EXPECT_EQ(map_of("color_by = \"det_f\"\ncolor_map = \"magma\""), "magma");
}

TEST(Coloring, MistakesAreToldWithWhatIsAllowed) {
  Scratch scratch;
  const auto told = [&](const std::string& output) -> std::string {
    try {
      load_scene(scratch.write("scene.toml", scene_with(output)));
    } catch (const UserError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(
      told("color_by = \"von_mise\""),
      AllOf(HasSubstr("scene.toml:6: output.color_by: unknown choice 'von_mise'; did you mean 'von_mises'?"),
            HasSubstr("none, displacement, speed")));
  EXPECT_THAT(told("color_map = \"jet\""), HasSubstr("automatic, viridis, cividis, magma, coolwarm"));
  EXPECT_THAT(told("color_range = 5"),
              HasSubstr("output.color_range: expected two numbers [low, high], found 5"));
  EXPECT_THAT(told("color_range = [2, 2]"), HasSubstr("expected low below high, both finite, found [2, 2]"));
  EXPECT_THAT(told("color_range = [0, inf]"), HasSubstr("both finite"));
  EXPECT_THAT(told("color_range = [0, nan]"), HasSubstr("color_range"));
}

TEST(Coloring, OptionsOfTheProgramSetTheKeys) {
  Scratch scratch;
  const std::string scene = scratch.write("scene.toml", small_scene()).string();
  const Said said = deforma_program(
      "run " + scene + " -o " + (scratch / "out").string() +
      " --frames 1:2 --no-video --quiet --color-by speed --color-map magma --color-range=-1:2e1");
  EXPECT_EQ(said.code, 0) << said.text;
  const json color = report_of(scratch, "out")["color"];
  EXPECT_EQ(color["field"], "speed");
  EXPECT_EQ(color["map"], "magma");
  EXPECT_EQ(color["range"], (json{-1.0, 20.0}));
  for (const auto& [option, part] :
       {std::pair{"--color-range 5", "--color-range 5: expected LOW:HIGH"},
        std::pair{"--color-range 5:1", "--color-range 5:1: output.color_range: expected low below high"},
        std::pair{"--color-range a:b", "--color-range a:b: output.color_range: expected two numbers"},
        std::pair{"--color-by sped", "did you mean 'speed'?"}}) {
    const Said refused =
        deforma_program("run " + scene + " -o " + (scratch / "other").string() + " " + option);
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.text, HasSubstr(part));
  }
}

}  // namespace
}  // namespace deforma
