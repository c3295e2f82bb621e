#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/text.h"
#include "pipeline/import/rate_check.h"
#include "pipeline/import/recording_warnings.h"
#include "sim/savitzky_golay.h"
#include "tests/message_of.h"
#include "tests/pipeline/import/encoder_motion.h"
#include "tests/words_of.h"

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

// What `change` makes of both rollouts' states.
Target with(const std::function<void(RowMatrix&)>& change, double dt = 0.004) {
  Target target = right_target(dt);
  for (Rollout& rollout : target.rollouts) change(rollout.states);
  return target;
}

Target with_factor(Index column, double factor) {
  return with([&](RowMatrix& states) { states.col(column) *= factor; });
}

TEST(RateReport, SaysWhatWasChecked) {
  EXPECT_EQ(join(problems(right_target()), "\n"), "");
  ASSERT_EQ(notes(right_target()).size(), 2u);
  EXPECT_TRUE(says(notes(right_target())[0], {"checked: theta_dot is the slope of theta"}));
  const Target still = with([](RowMatrix& states) { states.setZero(); });
  EXPECT_TRUE(says(notes(still)[1], {"not checked: whether alpha_dot is the slope of alpha"}));
  Target partly = right_target();
  partly.rollouts[1].states.setZero();
  EXPECT_TRUE(
      says(notes(partly)[0], {"checked: theta_dot is the slope of theta", "; not in 1 of"}));
}

// Rates and slopes disagree by the same 5 % wherever one looks, which scatters by much less.
TEST(RateReport, AClockThatIsSlightlyOffIsFound) {
  const auto clean = [](double dt, Index count, double lag) {
    Target target = right_target(dt);
    for (std::size_t h = 0; h < target.rollouts.size(); ++h) {
      RowMatrix states(count, 4);
      for (Index c = 0; c < 2; ++c) {
        const Motion motion =
            smooth_motion(count, 0.004, 2 * h + static_cast<std::uint64_t>(c) + 1);
        states.col(c) = rounded(motion.position, 1e-3);
        states.col(c + 2) = lagging(motion.rate, lag, 0.004);
      }
      target.rollouts[h].states = states;
    }
    return target;
  };
  EXPECT_TRUE(problems(clean(0.004, 1000, 0.0)).empty());
  ASSERT_EQ(problems(clean(0.0042, 1000, 0.0)).size(), 1u);
  EXPECT_TRUE(says(problems(clean(0.0042, 1000, 0.0)).front(),
                   {"theta changes 0.953 times", "dt is probably 0.0042 * 0.953"}));
  EXPECT_TRUE(problems(clean(0.0042, 1000, 0.03)).empty()) << "a filter is off by as much";
  EXPECT_TRUE(problems(clean(0.0042, 100, 0.0)).empty()) << "a part of a swing";
}

// Ratios themselves are those of rate_check_test.cpp, and words those of tests/golden/import.txt.
TEST(RateReport, NamesTheColumnAndItsFactor) {
  constexpr double degrees = 180.0 / M_PI, rpm = 30.0 / M_PI;
  const Target right = right_target();
  Target in_degrees = with_factor(2, degrees), one_file = right, wrapped = right, moved = right;
  in_degrees.state_channels[0].unit = "deg";
  in_degrees.state_channels[2].unit = "deg/s";
  one_file.rollouts[1].states.col(0) *= degrees;
  for (Index t = 200; t < 1000; t += 200) {
    wrapped.rollouts[1].states(t, 3) = -2.0 * M_PI / right.dt;
  }
  RowMatrix& states = moved.rollouts[1].states;
  states.col(1).tail(600).array() += 3.0;
  const std::string step = fmt::format("b.csv: alpha leaps by {:.3g} in the step after 1.596 s",
                                       states(400, 1) - states(399, 1));
  const std::vector<std::pair<Target, std::vector<std::string>>> cases = {
      {with_factor(3, degrees), {"alpha changes", "--scale alpha_dot=0.0174533"}},
      {in_degrees,
       {"theta changes", "theta [deg] is probably in radians", "--scale theta=57.2958"}},
      {with([](RowMatrix& s) { s.rightCols(2) *= 10.0; }),
       {"theta changes", "dt is probably 0.004 * 0.1"}},
      {with_factor(0, 995.0),  // nearly a power of ten
       {"theta changes 991 times as fast", "--scale theta=0.001 or --scale theta_dot=1000"}},
      {with_factor(0, 9.85), {"theta changes", "--scale theta_dot=9.81"}},  // of gravity
      {with_factor(0, 2.0), {"theta changes", "--scale theta=", "--scale theta_dot="}},
      {with_factor(3, -1.0),
       {"alpha changes", "alpha_dot [rad/s] probably has the wrong sign", "--scale alpha_dot=-1"}},
      {right_target(0.006),  // a ratio of all pairs is that of time
       {"theta changes", "alpha changes", "dt is probably 0.006 * ", "add --scale t="}},
      // Of a swing the slope of the rate, too, is nearly a multiple of the angle, and no unit's.
      {with([](RowMatrix& s) { s.col(0).swap(s.col(2)); }),
       {"theta is the slope of theta_dot: the two columns are swapped; correct the header"}},
      {one_file, {"b.csv: theta changes", "unlike in other files"}},
      {wrapped, {"alpha_dot jumps in 4 rows", "--unwrap alpha --differentiate"}},
      {with([](RowMatrix& s) {
         for (double& angle : s.col(1)) angle = std::remainder(8.0 * angle, 2.0 * M_PI);
       }),
       {"alpha changes", "times as fast as alpha_dot says"}},  // wraps don't hide a factor
      {moved, {step, "samples are missing"}}};
  for (const auto& [target, said] : cases) {
    const std::vector<std::string> all = problems(target);
    ASSERT_EQ(all.size(), 1u) << said.front() << ": " << join(all, "\n");
    EXPECT_TRUE(says(all.front(), said));
  }
  EXPECT_TRUE(has(problems(right_target(0.006), "").front(), "give --dt "));
  const std::vector<std::pair<Target, std::vector<std::string>>> pairs = {
      {with([&](RowMatrix& s) { s.rightCols(2) *= rpm; }),
       {"alpha changes 0.105 times as fast", "alpha_dot [rad/s] is probably in rpm",
        "alpha_dot=0.10472"}},
      {with([&](RowMatrix& s) { s.leftCols(2) *= degrees; }), {"alpha changes"}},  // no wrong time
      {with([](RowMatrix& s) { s.col(2).swap(s.col(3)); }),
       {"alpha_dot isn't the slope of alpha, but alpha_dot is that of theta", "swapped"}}};
  for (const auto& [target, said] : pairs) {
    const std::vector<std::string> both = problems(target);
    ASSERT_EQ(both.size(), 2u) << said.front() << ": " << join(both, "\n");
    EXPECT_TRUE(says(both.back(), said));
  }
  const auto unrelated = problems(with([](RowMatrix& s) { s.col(2) = s.col(3).eval(); }));
  ASSERT_EQ(unrelated.size(), 2u);
  EXPECT_TRUE(says(unrelated[0], {"a.csv: theta_dot isn't the slope of theta", "--differentiate"}));
}

// Of a swing of 1 rad/s the slope of the rate is the angle, with the other sign.
TEST(RateReport, ASwapNearOneRadianPerSecondIsNoWrongSign) {
  RowMatrix states(1000, 2);
  for (Index t = 0; t < states.rows(); ++t) {
    const double time = 0.01 * static_cast<double>(t);
    states.row(t) << std::cos(time), std::sin(time);
  }
  const Target swapped{0.01,
                       {{"theta", "rad"}, {"theta_dot", "rad/s"}},
                       {},
                       {{"a.csv", states, RowMatrix(999, 0)}},
                       "test"};
  const Findings all = find_in_rates(swapped, {{0, 1}}, "t");
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all.front().what,
            "theta is the slope of theta_dot: the two columns are swapped; correct the header");
}

// An angle that turns and swings, and its rate.
Target turning() {
  Target target{0.01, {{"alpha", "rad"}, {"alpha_dot", "rad/s"}}, {}, {}, "test"};
  for (const double phase : {0.0, 1.0}) {
    RowMatrix states(500, 2);
    for (Index t = 0; t < states.rows(); ++t) {
      const double time = 0.01 * static_cast<double>(t);
      states.row(t) << 2.0 * time + 0.5 * std::sin(3.0 * time + phase),
          2.0 + 1.5 * std::cos(3.0 * time + phase);
    }
    target.rollouts.push_back({phase == 0.0 ? "a" : "b", states, RowMatrix(499, 0)});
  }
  return target;
}

// The only one.
std::string warning(const Target& target) {
  const Findings all = warnings_of(target);
  EXPECT_EQ(all.size(), 1u) << words_of(all);
  return all.empty() ? "" : all.front().what;
}

void in_degrees(Target& target) {
  for (Rollout& rollout : target.rollouts) rollout.states.col(1) *= 180.0 / std::numbers::pi;
}

TEST(RecordingWarnings, ThereAreNoneOfARightOne) {
  Target target = turning();
  EXPECT_EQ(words_of(warnings_of(target)), "");
  target.state_channels[1].label = "alpha speed";
  EXPECT_EQ(words_of(warnings_of(target)), "");
}

// What is said of a recording that was changed; its rollouts are a and b.
TEST(RecordingWarnings, TellWhatImportsTell) {
  using Change = void (*)(Target&);
  const std::vector<std::pair<Change, std::string>> cases = {
      {[](Target& target) {
         for (double& angle : target.rollouts[1].states.col(0)) {
           angle = std::remainder(angle, 2.0 * std::numbers::pi);
         }
       },
       "alpha jumps by -6.249"},
      {in_degrees, "in an HDF5 file, correct the numbers"},
      // By a window that is longer than a swing, whose rates are far too small.
      {[](Target& target) {
         target.state_channels[1].label = "alpha speed";
         in_degrees(target);
       },
       "degrees"},
      {[](Target& target) {
         target.rollouts[1] = target.rollouts[0];
         target.rollouts[1].name = "b";
       },
       "rollout b holds the same numbers as rollout a"},
      // Leaps of what has no measured rate.
      {[](Target& target) {
         target.rollouts[1].states.col(0).tail(300).array() += 1.0;
         for (Rollout& rollout : target.rollouts) {
           rollout.states.col(1) = sim::slopes(rollout.states.col(0), 11, target.dt);
         }
       },
       "rollout b: alpha leaps by 1.03 in the step after 1.99 s"}};
  for (const auto& [change, said] : cases) {
    Target target = turning();
    change(target);
    EXPECT_TRUE(has(warning(target), said));
  }
}

TEST(RecordingWarnings, NamesOfRolloutsAreNoOptions) {
  Target target = turning();
  target.rollouts[1] = target.rollouts[0];
  target.rollouts[1].name = "a--b";
  EXPECT_FALSE(has(warning(target), "npdr import"));
}

TEST(RecordingWarnings, ThereAreNoneOfComputedRates) {
  Target target = turning();
  target.dt = 0.004;
  for (Rollout& rollout : target.rollouts) {
    for (Index t = 0; t < rollout.states.rows(); ++t) {
      rollout.states(t, 0) = 0.5 * std::sin(50.0 * target.dt * static_cast<double>(t));
    }
    rollout.states.col(0) *= rollout.name == "a" ? 1.0 : 0.8;
    rollout.states.col(1) = sim::slopes(rollout.states.col(0), 51, target.dt);
    rollout.states(0, 1) = 0.0;
  }
  EXPECT_EQ(words_of(warnings_of(target)), "");
  for (Rollout& rollout : target.rollouts) rollout.states.col(1) *= 1.001;  // measured, then
  EXPECT_NE(words_of(warnings_of(target)), "");
}

}  // namespace
}  // namespace npdr::pipeline
