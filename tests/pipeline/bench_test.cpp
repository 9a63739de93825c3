#include "pipeline/bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/pipeline/program.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

TEST(Turns, GiveEveryThingItsTurnAndTheTimeOfAUnitOfItsWork) {
  std::string order;
  std::vector<double> done;
  const std::vector<std::function<double(double)>> things = {[&](double amount) {
                                                               order += 'a';
                                                               done.push_back(amount);
                                                               return amount;
                                                             },
                                                             [&](double amount) {
                                                               order += 'b';
                                                               return 2.0 * amount;
                                                             }};
  const std::vector<double> seconds = take_turns(things, {.rounds = 4, .seconds = 1e-6});
  EXPECT_THAT(order, testing::EndsWith("abababab"));
  EXPECT_GE(*std::min_element(done.begin(), done.end()), 1.0);
  for (double each : seconds) {
    EXPECT_GT(each, 0.0);
    EXPECT_TRUE(std::isfinite(each));
  }
}

TEST(Turns, TakeTheMedian) {
  EXPECT_EQ(median({3.0, 1.0, 100.0}), 3.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 100.0}), 3.0);
}

TEST(BenchTable, AlignsItsColumnsAndShowsWhatThereIsNot) {
  const BenchTable table = {"speeds",
                            "How fast",
                            {{"name", "name", 0}, {"speed_metres_per_second", "speed\n[m/s]", 1}},
                            {{"snail", 0.013},
                             {"light in vacuum", 299792458.0},
                             {"thought", std::numeric_limits<double>::quiet_NaN()}},
                            {"By hearsay."}};
  EXPECT_EQ(bench_text(table),
            "How fast\n"
            "                       speed\n"
            "name                   [m/s]\n"
            "snail                    0.0\n"
            "light in vacuum  299792458.0\n"
            "thought                    -\n"
            "By hearsay.\n");
  const json all = json::parse(bench_json({.processor = "abacus", .threads = 2}, {table}));
  EXPECT_EQ(all["machine"]["processor"], "abacus");
  EXPECT_EQ(all["speeds"][0]["speed_metres_per_second"], 0.013);
  EXPECT_TRUE(all["speeds"][2]["speed_metres_per_second"].is_null());
}

TEST(Bench, AdvancesByAsManyStepsAsItIsTold) {
  World world = build(bench_scene(bench_box(64)));
  for (double steps : {1.0, 7.0}) EXPECT_EQ(advance_steps(*world.solver, steps), steps);
}

TEST(Bench, CountsTheLinksThatAStepReads) {
  BenchBody body = bench_box(1000);
  auto bytes = [&](double links) {
    body.links = links;
    return static_cast<double>(bytes_per_step(*build(bench_scene(body)).solver));
  };
  // Ten more links of a particle are read twice each at the least.
  EXPECT_GT(bytes(40) - bytes(30), 0.95 * 2 * 10 * 1000 * sizeof(Link));
}

TEST(BenchProgram, PrintsItsTablesAndWritesThemAsJson) {
  Scratch scratch;
  const auto file = scratch / "bench.json";
  Said said = deforma_program("bench --quick -n 128 --table steps --json " + file.string());
  ASSERT_EQ(said.code, 0) << said.text;
  EXPECT_THAT(said.text, AllOf(HasSubstr("memory bandwidth"), HasSubstr("Whole steps"), HasSubstr("Building"),
                               HasSubstr("linear, elastic + hourglass"), HasSubstr("quadratic, elastic")));
  const json all = json::parse(read_text_file(file));
  ASSERT_EQ(all["steps"].size(), 3u);
  for (const json& row : all["steps"]) {
    EXPECT_EQ(row["particles"], 128);
    for (const auto& [key, value] : row.items())
      if (value.is_number()) {
        EXPECT_GT(value.get<double>(), 0.0) << key;
      }
  }
  EXPECT_EQ(all["building"].size(), 2u);
  EXPECT_GT(all["machine"]["bandwidth_bytes_per_second"].get<double>(), 0.0);
}

TEST(BenchProgram, RefusesUnknownTablesAndTooFewParticles) {
  Said table = deforma_program("bench --table step");
  EXPECT_EQ(table.code, 2);
  EXPECT_THAT(table.text, AllOf(HasSubstr("--table step"), HasSubstr("did you mean 'steps'?")));
  EXPECT_EQ(deforma_program("bench -n 3").code, 2);
}

TEST(BenchProgram, MeasuresStagesThreadsEffectsAndThePapersObjects) {
  Said said =
      deforma_program("bench --quick --quiet --table stages --table threads --table effects --table paper");
  ASSERT_EQ(said.code, 0) << said.text;
  EXPECT_THAT(said.text, AllOf(HasSubstr("deformation gradient"), HasSubstr("threads"),
                               HasSubstr("lennard_jones"), HasSubstr("octahedron_in_box")));
  EXPECT_THAT(said.text, testing::Not(HasSubstr("measuring")));
}

}  // namespace
}  // namespace deforma
