#include "pipeline/figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/files.hpp"
#include "pipeline/run.hpp"
#include "pipeline/user_error.hpp"
#include "render/image.hpp"
#include "tests/pipeline/program.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Figure figure_of(const Scratch& scratch, const std::string& text) {
  scratch.write("scene.toml", small_scene());
  return load_figure(scratch.write("figure.toml", text));
}

TEST(Figure, ShowsWhatTheAnimationShows) {
  Scratch scratch;
  // 320 pixels at 254 dots per inch are 32 mm: the picture is a frame of the run, whole.
  const Page page = make_page(
      figure_of(
          scratch,
          "width = 65.5\ndpi = 254\nlabels = false\n[[row]]\nscene = \"scene.toml\"\ntimes = [0.08, 0.32]\n"),
      "auto");
  ASSERT_EQ(page.pictures.size(), 2u);
  RunOptions options;
  options.folder = scratch / "out";
  run_scene(load_scene(scratch / "scene.toml"), options);
  EXPECT_TRUE(page.pictures[0].image.rgba == read_png(scratch / "out/frames/0003.png").rgba);
  EXPECT_TRUE(page.pictures[1].image.rgba == read_png(scratch / "out/frames/0009.png").rgba);
  EXPECT_EQ(page.pictures[1].left, 33.5);
  EXPECT_EQ(page.pictures[1].stamp, "0.32 s");
  EXPECT_EQ(page.pictures[1].label, "");
  EXPECT_DOUBLE_EQ(page.height, 24.0);
}

TEST(Figure, AllPicturesShareOneRangeOfColours) {
  Scratch scratch;
  const Page page =
      make_page(figure_of(scratch,
                          "width = 80\ndpi = 100\ncolor_by = \"speed\"\n"
                          "[[row]]\nscene = \"scene.toml\"\ntimes = [0, 0.1]\n"
                          "[[row]]\nscene = \"scene.toml\"\ntimes = [0.2]\ncrop = [0.25, 0, 0.75, 1]\n"),
                "auto");
  ASSERT_TRUE(page.bar);
  EXPECT_EQ(page.bar->scale.low, 0.0);
  EXPECT_NEAR(page.bar->scale.high, 1.962, 0.1) << "the fastest, in the last row";
  ASSERT_EQ(page.pictures.size(), 3u);
  EXPECT_EQ(page.pictures[0].label, "(a)");
  EXPECT_EQ(page.pictures[2].label, "(c)");
  EXPECT_GT(page.pictures[2].top, page.pictures[0].top);
  const Image& cut = page.pictures[2].image;
  EXPECT_NEAR(static_cast<double>(cut.width) / cut.height, 160.0 / 240.0, 0.01);
  EXPECT_NEAR(cut.width, page.pictures[2].width / 25.4 * 100, 1.0);
}

TEST(Figure, ShippedFiguresAreInOrder) {
  for (const char* name : {"figure_8", "figure_9", "figure_10", "stress"}) {
    const Figure figure = load_figure(find_figure(name));
    EXPECT_EQ(figure.name, name);
    EXPECT_GE(figure.rows.size(), 2u);
  }
}

TEST(Figure, MistakesAreToldWithWhatIsAllowed) {
  Scratch scratch;
  const auto told = [&](const std::string& text) -> std::string {
    try {
      figure_of(scratch, text);
    } catch (const UserError& error) {
      return error.what();
    }
    return "nothing";
  };
  const std::string row = "[[row]]\nscene = \"scene.toml\"\n";
  EXPECT_THAT(told("width = 100\n"), HasSubstr("no [[row]]"));
  EXPECT_THAT(told("widht = 100\n" + row + "times = [0]\n"),
              HasSubstr("figure.toml:1: unknown key 'widht'; did you mean 'width'?"));
  EXPECT_THAT(told(row), HasSubstr("row: missing key 'times'"));
  EXPECT_THAT(told(row + "times = 0\n"),
              HasSubstr("figure.toml:3: row.times: expected a list of times in s, found 0"));
  EXPECT_THAT(told(row + "times = [0.2, 0.1]\n"), HasSubstr("expected ascending times in [0, 0.4]"));
  EXPECT_THAT(told(row + "times = [1]\n"), HasSubstr("expected ascending times in [0, 0.4]"));
  EXPECT_THAT(told(row + "times = [0]\ncrop = [0.6, 0, 0.4, 1]\n"),
              HasSubstr("row.crop: expected four numbers"));
  EXPECT_THAT(told("color_by = \"heat\"\n" + row + "times = [0]\n"),
              AllOf(HasSubstr("figure.toml:1: color_by"), HasSubstr("von_mises")));
  EXPECT_THAT(told("[[row]]\nscene = \"scen.toml\"\ntimes = [0]\n"),
              AllOf(HasSubstr("figure.toml:2: row.scene"), HasSubstr("no such scene file")));
  EXPECT_THAT(told("width = 12\n[[row]]\nscene = \"scene.toml\"\ntimes = [0, 0.1, 0.2]\n"), "nothing");
  EXPECT_THROW(make_page(figure_of(scratch, "width = 12\n" + row + "times = [0, 0.1, 0.2]\n"), "auto"),
               UserError);
}

TEST(Figure, TheProgramWritesThreeFilesAndReplacesNoneUnasked) {
  Scratch scratch;
  scratch.write("scene.toml", small_scene());
  const std::string figure =
      scratch
          .write("small.toml", "width = 40\ndpi = 100\n[[row]]\nscene = \"scene.toml\"\ntimes = [0, 0.2]\n")
          .string();
  const std::string line = "figure " + figure + " -o " + (scratch / "out").string();
  const Said said = deforma_program(line);
  EXPECT_EQ(said.code, 0) << said.text;
  for (const char* name : {"small.png", "small.pdf", "small.svg"})
    EXPECT_GT(std::filesystem::file_size(scratch / "out" / name), 100u);
  const Said again = deforma_program(line);
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.text, AllOf(HasSubstr("small.png: exists"), HasSubstr("--overwrite")));
  EXPECT_EQ(deforma_program(line + " --overwrite --quiet").text, "");
  const Said unknown = deforma_program("figure figure_80");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.text, AllOf(HasSubstr("no such figure file"), HasSubstr("figure_8")));
}

}  // namespace
}  // namespace deforma
