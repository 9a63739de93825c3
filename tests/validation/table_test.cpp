#include "pipeline/validation_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace deforma {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
const ValidationSetting& judged = validation_settings()[0];
const ValidationSetting& paper = validation_settings()[2];

const Criterion& sag() { return find_criterion("dropped-beam", "twice the mean sag"); }  // 0.0979 m

ValidationRow row(double value, int n = 6, const ValidationSetting& setting = judged) {
  return {.criterion = &sag(),
          .variant = {&setting, Placement::lattice, n},
          .particles = 864,
          .value = value,
          .cpu = 1.25,
          .trouble = {}};
}

TEST(ValidationCriterion, JudgesByGoalAndLimitOfTheParticlesAcross) {
  const double r = sag().reference;
  EXPECT_EQ(judge(sag(), 4, 1.049 * r), Verdict::ok);
  EXPECT_EQ(judge(sag(), 4, 0.951 * r), Verdict::ok);
  EXPECT_EQ(judge(sag(), 4, 1.051 * r), Verdict::missed);
  EXPECT_EQ(judge(sag(), 4, 0.919 * r), Verdict::failed);
  EXPECT_EQ(judge(sag(), 6, 1.019 * r), Verdict::ok);
  EXPECT_EQ(judge(sag(), 6, 0.979 * r), Verdict::missed);
  EXPECT_EQ(judge(sag(), 10, 1.051 * r), Verdict::failed);
  EXPECT_EQ(judge(sag(), 6, none), Verdict::failed);
}

TEST(ValidationCriterion, SomeHaveNoLimitAndSomeAreErrorsThemselves) {
  const Criterion& cpu = find_criterion("dropped-beam", "CPU for 1.2 s");
  EXPECT_EQ(judge(cpu, 4, 0.5), Verdict::ok);
  EXPECT_EQ(judge(cpu, 4, 50.0), Verdict::missed);
  EXPECT_EQ(judge(find_criterion("dropped-beam", "largest deflection"), 4, 99.0), Verdict::shown);
  const Criterion& below = find_criterion("free-bar", "modes below");
  EXPECT_EQ(judge(below, 6, 0.0), Verdict::ok);
  EXPECT_EQ(judge(below, 6, 1.0), Verdict::failed);
  const Criterion& patch = find_criterion("patch", "strain error");
  EXPECT_EQ(judge(patch, 6, 1e-10), Verdict::ok);
  EXPECT_EQ(judge(patch, 6, 1.1e-9), Verdict::failed);
}

TEST(ValidationCriterion, StaticAndFrequencyCasesHaveTheSameGoalsAndLimits) {
  for (const Criterion& c : validation_criteria()) {
    if (c.comparison != Comparison::relative || !std::isfinite(c.fine.limit)) continue;
    EXPECT_EQ(c.coarse.goal, 0.05) << c.case_name;
    EXPECT_EQ(c.coarse.limit, 0.08) << c.case_name;
    EXPECT_EQ(c.fine.goal, 0.02) << c.case_name;
    EXPECT_EQ(c.fine.limit, 0.05) << c.case_name;
  }
}

TEST(ValidationCriterion, EveryCaseHasCriteriaAndEveryCriterionACase) {
  std::set<std::string_view> cases, judged_cases;
  for (const ValidationCase& one : validation_cases()) EXPECT_TRUE(cases.insert(one.name).second) << one.name;
  for (const Criterion& c : validation_criteria()) judged_cases.insert(c.case_name);
  EXPECT_EQ(cases, judged_cases);
  EXPECT_THROW(find_criterion("patch", "no such thing"), std::out_of_range);
}

TEST(ValidationRows, OnlyTheDefaultIsJudged) {
  EXPECT_EQ(row(1.0).verdict(), Verdict::failed);
  EXPECT_EQ(row(1.0, 6, paper).verdict(), Verdict::shown);
  EXPECT_EQ(row(none, 6, paper).verdict(), Verdict::shown);
  EXPECT_FALSE(all_limits_kept({row(sag().reference), row(1.0)}));
  EXPECT_FALSE(all_limits_kept({row(none)}));
  EXPECT_TRUE(all_limits_kept({row(sag().reference), row(1.03 * sag().reference), row(1.0, 6, paper)}));
}

TEST(ValidationRows, TooMuchStrainFailsACaseOfSmallStrain) {
  ValidationRow strained = row(sag().reference);
  strained.strain = 2e-3;
  EXPECT_EQ(strained.verdict(), Verdict::ok);
  strained.small = true;
  EXPECT_EQ(strained.verdict(), Verdict::failed);
  EXPECT_THAT(validation_text({strained}), HasSubstr("the largest strain is 0.002, above 0.001"));
  strained.strain = 0.9e-3;
  EXPECT_EQ(strained.verdict(), Verdict::ok);
}

TEST(ValidationRows, AreSortedBySettingPlacementAndSize) {
  ValidationRow jittered = row(1.0, 4);
  jittered.variant.placement = Placement::jittered;
  std::vector<ValidationRow> rows = {row(1.0, 6, paper), row(1.0, 10), jittered, row(1.0, 4)};
  sort_rows(rows);
  EXPECT_EQ(rows[0].variant.n, 4);
  EXPECT_EQ(rows[1].variant.n, 10);
  EXPECT_EQ(rows[2].variant.placement, Placement::jittered);
  EXPECT_EQ(rows[3].variant.setting, &paper);
}

TEST(ValidationTable, MarkdownShowsEveryColumn) {
  ValidationRow troubled = row(none, 4, paper);
  troubled.trouble = "no equilibrium";
  std::string text = validation_markdown({row(1.03 * 0.0979), troubled});
  EXPECT_THAT(
      text,
      HasSubstr("| dropped-beam | twice the mean sag | lattice | default | 6 | 864 | 0.10084 | 0.0979 | m | "
                "+3.00 % | 2 % | 5 % | missed | 1.25 |"));
  EXPECT_THAT(text, HasSubstr("| paper | 4 | 864 | none | 0.0979 | m |  |  |  | shown | 1.25 |"));
  EXPECT_THAT(text, HasSubstr("* dropped-beam, twice the mean sag: 0.0979 m (27-node bricks"));
  EXPECT_THAT(text, HasSubstr("* dropped-beam, lattice, paper, n = 4: no equilibrium"));
  EXPECT_THAT(text, HasSubstr("0 ok, 1 missed their goal, 0 FAILED their limit, 1 shown without."));
}

TEST(ValidationTable, TextHasAColumnForEachAndSaysWhatFailed) {
  std::string text = validation_text({row(0.0979), row(0.2)});
  EXPECT_THAT(text, HasSubstr("+0.00 %"));
  EXPECT_THAT(text, HasSubstr("FAILED"));
  EXPECT_THAT(text, HasSubstr("1 ok, 0 missed their goal, 1 FAILED their limit, 0 shown without."));
  EXPECT_THAT(text, Not(HasSubstr("Trouble")));
}

TEST(ValidationTable, SaysWhatDoesNotConverge) {
  std::string text = validation_text({row(1.01 * 0.0979, 4), row(1.04 * 0.0979, 6), row(1.02 * 0.0979, 8)});
  EXPECT_THAT(
      text,
      HasSubstr("dropped-beam, twice the mean sag, lattice: off by 1.00 % at n = 4 and 2.00 % at n = 8\n"));
  EXPECT_THAT(validation_text({row(1.04 * 0.0979, 4), row(0.99 * 0.0979, 8)}),
              Not(HasSubstr("Not converging")));
  // What is near zero may wander there.
  EXPECT_THAT(validation_text({row(1.001 * 0.0979, 4), row(1.005 * 0.0979, 8)}),
              Not(HasSubstr("Not converging")));
}

TEST(ValidationTable, CsvHoldsFullNumbersAndQuotesCommas) {
  ValidationRow troubled = row(none, 4);
  troubled.trouble = "left: 3 \"things\", or 4";
  std::string text = validation_csv({row(0.13), troubled});
  EXPECT_THAT(
      text, testing::StartsWith("case,quantity,placement,setting,n,particles,value,reference,unit,error,goal,"
                                "limit,verdict,largest_strain,cpu_s,source,trouble\n"));
  EXPECT_THAT(text,
              HasSubstr("dropped-beam,twice the mean sag,lattice,default,6,864,0.13,0.0979,m,0.32788559"));
  EXPECT_THAT(text, HasSubstr(",0.02,0.05,FAILED,0,1.25,\"27-node bricks, up to 10 across and extrapolated, "
                              "root fully clamped\",\n"));
  EXPECT_THAT(text, HasSubstr("864,,0.0979,m,,0.05,0.08,FAILED"));
  EXPECT_THAT(text, HasSubstr("\"left: 3 \"\"things\"\", or 4\"\n"));
}

}  // namespace
}  // namespace deforma
