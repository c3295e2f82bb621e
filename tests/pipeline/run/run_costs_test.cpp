#include "pipeline/run/run_progress.h"

#include "tests/pipeline/small_study.h"

namespace npdr::pipeline {
namespace {

TEST(RunCosts, ComeFromTheNearestKin) {
  const Plan plan = make_plan(parse_study(kStudyText, "s.toml", {}), WorkFolder("none"));
  RunCosts costs(plan);
  const Node& maf = plan.node(Stage::infer, {"NPDR (MAF)", 1, 1});
  const Node& other_seed = plan.node(Stage::infer, {"NPDR (MAF)", 2, 1});
  const Node& mog = plan.node(Stage::infer, {"NPDR (MoG)", 1, 1});
  const Node& few = plan.node(Stage::simulate, {"NPDR (MAF)", 1, 1});   // 200 rows
  const Node& many = plan.node(Stage::simulate, {"NPDR (MoG)", 1, 1});  // 1000 rows
  EXPECT_FALSE(costs.expected(maf));
  costs.learn(few, 10.0);
  EXPECT_DOUBLE_EQ(*costs.expected(many), 10.0 * static_cast<double>(num_rows(plan, many)) / 200.0)
      << "by the row";
  EXPECT_FALSE(costs.expected(maf)) << "simulations say nothing of training";
  costs.learn(maf, 30.0);
  EXPECT_DOUBLE_EQ(*costs.expected(other_seed), 30.0);
  EXPECT_DOUBLE_EQ(*costs.expected(mog), 30.0) << "as the stage";
  costs.learn(mog, 2.0);
  EXPECT_DOUBLE_EQ(*costs.expected(other_seed), 30.0);
}

// Ten rounds: proposals and simulations have shown what they cost, trainings haven't.
TEST(WorkLeft, TellsAShareOnceEachStageHasShownItsCost) {
  WorkLeft rest;
  EXPECT_EQ(rest.share_done(5.0, 1), 1.0) << "nothing is left";
  for (int i = 0; i < 9; ++i) {
    rest.add(Stage::propose, 0.5);
    rest.add(Stage::simulate, 1.5);
  }
  rest.add(Stage::report, {});
  EXPECT_DOUBLE_EQ(*rest.share_done(19.0, 19), 0.5) << "the report: as much as any";
  rest.add(Stage::infer, 100.0);
  EXPECT_LT(*rest.share_done(19.0, 19), 0.15);
  rest.add(Stage::evaluate, {});
  EXPECT_TRUE(rest.share_done(19.0, 19));
  rest.add(Stage::evaluate, {});
  EXPECT_FALSE(rest.share_done(19.0, 19)) << "two of a stage";
}

TEST(WorkLeft, TakesAReportAloneForOneOfMany) {
  WorkLeft rest;
  rest.add(Stage::report, {});
  EXPECT_DOUBLE_EQ(*rest.share_done(19.0, 19), 0.95);
  EXPECT_FALSE(rest.share_done(1.0, 0)) << "it is all there is";
  rest.add(Stage::evaluate, {});
  EXPECT_FALSE(rest.share_done(19.0, 19)) << "another stage may cost more than all before";
}

}  // namespace
}  // namespace npdr::pipeline
