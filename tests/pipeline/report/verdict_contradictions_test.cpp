#include "tests/message_of.h"
#include "tests/pipeline/report/verdict_fixture.h"

namespace npdr::pipeline {
namespace {

TEST_F(Verdicts, SeedsThatContradictEachOtherAreSaid) {
  data_.seeds = {1, 2};
  data_.runs.push_back(data_.runs.front());
  data_.runs.back().use.seed = 2;
  EXPECT_EQ(verdict_of(Check::contraction).reason, "");
  data_.runs.back().evaluation.theta = samples_around(1.1, 0.02);  // five deviations off
  EXPECT_TRUE(says(verdict_of(Check::contraction).reason,
                   {"seeds contradict each other about pole_mass (3.5), pole_length (3.5)",
                    "none is to be believed", "try more simulations"}));
  plan_.study.policy.search.kind = inference::PolicyOptimizerKind::power;
  plan_.study.methods.front().num_iterations = 2;
  EXPECT_EQ(verdict_of(Check::contraction).reason, "") << "each has an observation of its own";
}

TEST_F(Verdicts, MethodsThatContradictEachOtherAreSaid) {
  data_.methods.push_back("NPDR (MoG)");
  data_.runs.push_back(data_.runs.front());
  data_.runs.back().use.method = "NPDR (MoG)";
  data_.runs.back().evaluation.theta = samples_around(1.08, 0.02);
  EXPECT_EQ(verdict_of(Check::contraction).reason, "") << "2.8 deviations";
  data_.runs.back().evaluation.theta = samples_around(1.1, 0.02);
  EXPECT_TRUE(says(
      verdict_of(Check::contraction).reason,
      {"contradicts NPDR (MoG) about pole_mass", "(3.5 deviations apart)", "held-out rollouts"}));
  data_.runs.back().evaluation.theta.col(0).setConstant(0.5);
  data_.runs.back().evaluation.theta.col(1) = data_.runs.front().evaluation.theta.col(1);
  EXPECT_EQ(verdict_of(Check::contraction).reason, "") << "taken as known";
}

}  // namespace
}  // namespace npdr::pipeline
