#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/build.hpp"
#include "pipeline/validation_case.hpp"
#include "tests/pipeline/program.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ValidateProgram, PrintsTheTableAndWritesItTwice) {
  Scratch scratch;
  Said said =
      deforma_program("validate --case free-fall -n 4 --settings default -o " + (scratch / "out").string());
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_THAT(said.text, HasSubstr("[1/"));  // progress, on standard error
  EXPECT_THAT(said.text, HasSubstr("free-fall  relative error  lattice"));
  EXPECT_THAT(said.text, HasSubstr("0 FAILED"));
  EXPECT_THAT(read_text_file(scratch / "out/validation.md"),
              HasSubstr("| free-fall | relative error | lattice |"));
  EXPECT_THAT(read_text_file(scratch / "out/validation.csv"),
              HasSubstr("\nfree-fall,relative error,lattice,default,4,64,"));
}

TEST(ValidateProgram, ALimitThatFailsEndsWithOne) {
  // Twice as stiff as its reference says.
  Said said = deforma_program(
      "validate --quiet --case cantilever -n 4 --settings default --set body.0.elastic.young=2e6");
  EXPECT_EQ(said.code, 1);
  EXPECT_THAT(said.text, HasSubstr("FAILED"));
  EXPECT_THAT(said.text, Not(HasSubstr("[1/")));
}

TEST(ValidateProgram, SettingsBesideTheDefaultNeverFail) {
  Said said = deforma_program(
      "validate --quiet --case hanging-bar -n 4 --settings paper --set body.0.elastic.young=2e6");
  EXPECT_EQ(said.code, 0);
  EXPECT_THAT(said.text, HasSubstr("shown"));
}

TEST(ValidateProgram, ListsTheCases) {
  Said said = deforma_program("validate --list");
  EXPECT_EQ(said.code, 0);
  for (const ValidationCase& one : validation_cases())
    EXPECT_THAT(said.text, HasSubstr(std::string(one.name)));
}

TEST(ValidateProgram, RefusesNamesThatAreNone) {
  Said said = deforma_program("validate --case cantilevr");
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.text, HasSubstr("did you mean 'cantilever'?"));
  said = deforma_program("validate --settings papr");
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.text, HasSubstr("did you mean 'paper'?"));
  said = deforma_program("validate --case rotation -n 4");
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.text, HasSubstr("nothing to validate"));
  said = deforma_program("validate --quiet --case free-fall -n 4 --set body.0.elastic.yung=1");
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.text, HasSubstr("young"));
}

TEST(ValidateProgram, WritesScenesThatCanBeRun) {
  Scratch scratch;
  Said said = deforma_program("validate --write " + (scratch / "scenes").string());
  ASSERT_EQ(said.code, 0) << said.text;
  for (const ValidationCase& one : validation_cases()) {
    std::filesystem::path file = scratch / ("scenes/" + std::string(one.name) + ".toml");
    ASSERT_TRUE(std::filesystem::exists(file)) << file;
    World world = build(load_scene(file));
    EXPECT_GT(world.bodies.at(0).particles, 100u) << one.name;
  }
}

}  // namespace
}  // namespace deforma
