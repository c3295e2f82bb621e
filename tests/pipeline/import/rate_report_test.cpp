#include "pipeline/import/rate_report.h"

#include <fmt/format.h>

#include "core/text.h"
#include "tests/message_of.h"
#include "tests/pipeline/import/encoder_motion.h"

namespace npdr::pipeline {
namespace {

const std::vector<std::string> kFiles = {"a.csv", "b.csv"};
const std::vector<RatePair> kPairs = {{0, 2}, {1, 3}};

// Two rollouts of a Furuta pendulum's channels: what encoders and differences give of two motions.
Target right_target(double dt = 0.004) {
  Target target{
      dt,
      {{"theta", "rad"}, {"alpha", "rad"}, {"theta_dot", "rad/s"}, {"alpha_dot", "rad/s"}},
      {},
      {},
      "test"};
  for (std::uint64_t h = 0; h < kFiles.size(); ++h) {
    RowMatrix states(1000, 4);
    for (Index c = 0; c < 2; ++c) {
      const auto row = 2 * h + static_cast<std::uint64_t>(c) + 1;
      const Motion motion = recorded(smooth_motion(1000, 0.004, row), row)[2];
      states.col(c) = motion.position;
      states.col(c + 2) = motion.rate;
    }
    target.rollouts.push_back({kFiles[h], states, RowMatrix(999, 0)});
  }
  return target;
}

// Problems, or notes of what was checked.
std::vector<std::string> problems(const Target& target, const std::string& time = "t",
                                  Severity severity = Severity::suspicious) {
  std::vector<std::string> words;
  for (const Finding& finding : find_in_rates(target, kPairs, time)) {
    if (finding.severity == severity) words.push_back(finding.what);
  }
  return words;
}

std::vector<std::string> notes(const Target& target) {
  return problems(target, "t", Severity::note);
}

Target with_factor(Index column, double factor) {
  Target target = right_target();
  for (Rollout& rollout : target.rollouts) rollout.states.col(column) *= factor;
  return target;
}

// The only problem.
std::string problem(const Target& target, const std::string& time = "t") {
  const std::vector<std::string> all = problems(target, time);
  EXPECT_EQ(all.size(), 1u) << join(all, "\n");
  return all.empty() ? "" : all.front();
}

TEST(RateReport, SaysWhatWasChecked) {
  EXPECT_EQ(join(problems(right_target()), "\n"), "");
  ASSERT_EQ(notes(right_target()).size(), 2u);
  EXPECT_TRUE(says(notes(right_target())[0], {"checked: theta_dot is the slope of theta"}));
  Target still = right_target();
  for (Rollout& rollout : still.rollouts) rollout.states.setZero();
  EXPECT_TRUE(says(notes(still)[1], {"not checked: whether alpha_dot is the slope of alpha"}));
  Target partly = right_target();
  partly.rollouts[1].states.setZero();
  EXPECT_TRUE(
      says(notes(partly)[0], {"checked: theta_dot is the slope of theta", "; not in 1 of"}));
}

TEST(RateReport, NamesTheColumnInDegrees) {
  EXPECT_TRUE(says(problem(with_factor(0, 180.0 / M_PI)),
                   {"theta changes", "times as fast as theta_dot says",
                    "theta [rad] is probably in degrees", "--scale theta=0.0174533"}));
  EXPECT_TRUE(says(problem(with_factor(3, 180.0 / M_PI)),
                   {"alpha changes", "times as fast as alpha_dot says",
                    "alpha_dot [rad/s] is probably in degrees", "--scale alpha_dot=0.0174533"}));
  Target target = with_factor(0, 1.0);
  target.state_channels[0].unit = "deg";
  target.state_channels[2].unit = "deg/s";
  for (Rollout& rollout : target.rollouts) rollout.states.col(2) *= 180.0 / M_PI;
  EXPECT_TRUE(says(problem(target), {"theta changes", "theta [deg] is probably in radians",
                                     "--scale theta=57.2958"}));
}

TEST(RateReport, NamesRatesInRpm) {
  Target target = with_factor(2, 30.0 / M_PI);
  for (Rollout& rollout : target.rollouts) rollout.states.col(3) *= 30.0 / M_PI;
  const std::vector<std::string> all = problems(target);
  ASSERT_EQ(all.size(), 2u) << join(all, "\n");
  EXPECT_TRUE(says(all[1], {"alpha changes 0.105 times as fast",
                            "alpha_dot [rad/s] is probably in rpm", "--scale alpha_dot=0.10472"}));
  for (Rollout& rollout : target.rollouts) rollout.states.rightCols(2) *= M_PI / 30.0 * 10.0;
  EXPECT_TRUE(says(problem(target), {"theta changes", "dt is probably 0.004 * 0.1"}));
}

TEST(RateReport, GivesPowersOfTenForFactorsThatAreNearly) {
  EXPECT_TRUE(
      says(problem(with_factor(0, 995.0)),
           {"theta changes 991 times as fast", "--scale theta=0.001 or --scale theta_dot=1000"}));
  EXPECT_TRUE(says(problem(with_factor(0, 9.85)), {"theta changes", "--scale theta_dot=9.81"}))
      << "in units of gravity";
}

// Ratios themselves are those of rate_check_test.cpp.
TEST(RateReport, ARatioOfAllPairsIsThatOfTime) {
  const Target target = right_target(0.006);
  EXPECT_TRUE(says(problem(target), {"theta changes", "alpha changes", "dt is probably 0.006 * ",
                                     "correct column 't', or add --scale t="}));
  EXPECT_TRUE(says(problem(target, ""), {"theta changes", "dt is probably 0.006 *", "give --dt "}));
}

TEST(RateReport, DegreesEverywhereAreNoWrongTime) {
  Target target = with_factor(0, 180.0 / M_PI);
  for (Rollout& rollout : target.rollouts) rollout.states.col(1) *= 180.0 / M_PI;
  EXPECT_EQ(problems(target).size(), 2u);
}

TEST(RateReport, OtherFactorsAndSignsAreNamed) {
  EXPECT_TRUE(says(problem(with_factor(0, 2.0)),
                   {"theta changes", "another unit", "--scale theta=", "--scale theta_dot="}));
  EXPECT_TRUE(says(
      problem(with_factor(3, -1.0)),
      {"alpha changes", "alpha_dot [rad/s] probably has the wrong sign", "--scale alpha_dot=-1"}));
}

TEST(RateReport, FindsColumnsThatAreSwapped) {
  Target target = right_target();
  for (Rollout& rollout : target.rollouts) rollout.states.col(2).swap(rollout.states.col(3));
  EXPECT_TRUE(says(problems(target).front(), {"theta_dot", "theta", "swapped"}));
}

// Of a swing the slope of the rate, too, is nearly a multiple of the angle: a negative one.
TEST(RateReport, FindsAPositionAndARateThatAreSwapped) {
  Target target = right_target();
  for (Rollout& rollout : target.rollouts) rollout.states.col(0).swap(rollout.states.col(2));
  EXPECT_FALSE(problems(target).empty());
}

TEST(RateReport, NamesTheFilesThatAreUnlikeTheOthers) {
  Target target = right_target();
  target.rollouts[1].states.col(0) *= 180.0 / M_PI;
  EXPECT_TRUE(says(problem(target), {"b.csv: theta changes", "unlike in other files"}));
  target = right_target();
  for (Rollout& rollout : target.rollouts) rollout.states.col(2) = rollout.states.col(3);
  const std::vector<std::string> both = problems(target);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_TRUE(says(both[0], {"a.csv: theta_dot isn't the slope of theta", "--differentiate"}));
}

TEST(RateReport, NamesRatesOfWrappedAngles) {
  Target target = right_target();
  for (Index t = 200; t < 1000; t += 200) {
    target.rollouts[1].states(t, 3) = -2.0 * M_PI / target.dt;
  }
  EXPECT_TRUE(says(problem(target), {"alpha_dot jumps in 4 rows", "an angle that wraps",
                                     "--unwrap alpha --differentiate"}));
}

TEST(RateReport, NamesStepsThatTheRateKnowsNothingOf) {
  Target target = right_target();
  target.rollouts[1].states.col(1).tail(600).array() += 3.0;
  const Rollout& rollout = target.rollouts[1];
  const double step = rollout.states(400, 1) - rollout.states(399, 1);
  EXPECT_TRUE(says(problem(target), {fmt::format("b.csv: alpha leaps by {:.3g} in the step after "
                                                 "1.596 s, alpha_dot says by ",
                                                 step),
                                     "samples are missing"}));
}

TEST(RateReport, WrapsDontHideAFactor) {
  Target target = right_target();
  for (Rollout& rollout : target.rollouts) {
    for (double& angle : rollout.states.col(1)) angle = std::remainder(8.0 * angle, 2.0 * M_PI);
  }
  EXPECT_TRUE(says(problem(target), {"alpha changes", "times as fast as alpha_dot says"}));
}

}  // namespace
}  // namespace npdr::pipeline
