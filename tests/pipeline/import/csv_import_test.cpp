#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "pipeline/import/csv_import.h"
#include "pipeline/import/csv_rows.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::string kCsv =
    "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n"
    "0.0,0.1,1,5\n"
    "0.1,0.2,2,6\n"
    "0.2,0.3,3,7\n";

CsvOptions pendulum_options() {
  return {.channels = channels_of(sim::make_simulator({.name = "pendulum"})->info()),
          .dt = {},
          .source = ""};
}

class CsvImport : public FolderTest {
 protected:
  Target imported(const std::string& text, const CsvOptions& options = pendulum_options()) const {
    return import_csv({folder_.file("a.csv", text)}, options).target;
  }
};

const RowMatrix kStates{{0.1, 1}, {0.2, 2}, {0.3, 3}}, kActions{{5}, {6}};

TEST_F(CsvImport, ReadsStatesAndActionsInTheSimulatorsOrder) {
  const Target target = imported(kCsv);
  EXPECT_DOUBLE_EQ(target.dt, 0.1);
  EXPECT_EQ(target.state_channels, pendulum_options().channels.states);
  EXPECT_EQ(target.num_steps(), 2);
  EXPECT_EQ(target.rollouts[0].name, "a");
  EXPECT_EQ(target.source, "a.csv");
  EXPECT_EQ(target.rollouts[0].states, kStates);
  EXPECT_EQ(target.rollouts[0].actions, kActions) << "the last action is ignored";
}

TEST_F(CsvImport, TakesNamedColumnsAndIgnoresTheRest) {
  const CsvOptions options = {
      .channels = {{{"theta_dot", ""}, {"theta", "rad"}}, {}}, .dt = {}, .source = "bench"};
  const Target target = imported(kCsv, options);
  EXPECT_EQ(target.state_channels,
            (std::vector<Channel>{{"theta_dot", "rad/s"}, {"theta", "rad"}}));
  EXPECT_EQ(target.num_actions(), 0);
  EXPECT_EQ(target.source, "bench");
  EXPECT_EQ(target.rollouts[0].states(2, 0), 3.0);
}

TEST_F(CsvImport, ReadsWhatSpreadsheetsAndOtherCountriesWrite) {
  CsvOptions european = pendulum_options();
  european.format = {';', true};
  const std::vector<std::pair<std::string, CsvOptions>> cases = {
      {"\xEF\xBB\xBF\"time [s]\", theta [rad] ,\"theta_dot [rad/s]\",torque [N m]\r\n"
       "0,\"0.1\", +1e0 ,5\r\n1e-1,.2,2,6\r\n0.2,0.3,3,\r\n\r\n  \r\n",
       pendulum_options()},
      {"t [s];theta [rad];theta_dot [rad/s];torque [N m]\n0;0,1;1;5\n0,1;0,2;2;6\n0,2;0,3;3;\n",
       european}};
  for (const auto& [text, options] : cases) {
    const Target target = imported(text, options);
    EXPECT_EQ(target.rollouts[0].states, kStates);
    EXPECT_EQ(target.rollouts[0].actions, kActions);
  }
}

TEST_F(CsvImport, HeadersMayHoldCommasQuotesAndBrackets) {
  const CsvOptions options = {
      .channels = {{{"x[0]", "m"}, {"x[1] [old]", ""}, {"a, \"b\"", ""}}, {}},
      .dt = 0.5,
      .source = ""};
  EXPECT_EQ(imported("x[0] [m],x[1] [old] [mm],\"a, \"\"b\"\" [m]\"\n1,2,3\n3,4,5\n", options)
                .state_channels,
            (std::vector<Channel>{{"x[0]", "m"}, {"x[1] [old]", "mm"}, {"a, \"b\"", "m"}}));
}

TEST_F(CsvImport, JoinsFilesAsRolloutsThatTheirFoldersTellApart) {
  for (const char* day : {"monday", "friday"}) {
    std::filesystem::create_directory(folder_ / day);
  }
  const Target target =
      import_csv({folder_.file("monday/run.csv", kCsv),
                  folder_.file("friday/run.csv", edited(kCsv, "0.2,0.3", "0.2,0.4")),
                  folder_.file("b.csv", edited(kCsv, "0.2,0.3", "0.2,0.5"))},
                 pendulum_options())
          .target;
  ASSERT_EQ(target.num_rollouts(), 3);
  EXPECT_EQ(target.rollouts[0].name, "monday/run");
  EXPECT_EQ(target.rollouts[1].name, "friday/run");
  EXPECT_TRUE(target.rollouts[2].name.ends_with("b"));
}

TEST_F(CsvImport, TakesTheTimeStepFromAClockOrTheOption) {
  for (const char* name : {"Time [s]", "ros_timestamp [s]", "Zeit [s]", "T [s]"}) {
    EXPECT_EQ(imported(edited(kCsv, "t [s]", name)).dt, 0.1) << name;
  }
  CsvOptions options = pendulum_options();
  options.dt = 0.02;
  EXPECT_EQ(imported(edited(kCsv, "t [s]", "row [1]"), options).dt, 0.02);
  options.dt = 0.1;
  EXPECT_EQ(imported(kCsv, options).dt, 0.1);
  options.channels.actions = {{"t", "N m"}};  // a channel is no clock
  const std::string text = "theta [rad],theta_dot [rad/s],t [N m]\n0.1,1,5\n0.2,2,6\n0.3,3,7\n";
  EXPECT_EQ(imported(text, options).rollouts[0].actions, kActions);
}

TEST_F(CsvImport, ScalesColumns) {
  CsvOptions options = pendulum_options();
  options.scales = {{"theta", 0.1}, {"t", 1e-3}, {"torque", -1.0}};
  const std::string text = edited(edited(kCsv, "theta [rad]", "theta [deg]"), "t [s]", "t [ms]");
  const Target target = imported(text, options);
  EXPECT_EQ(target.state_channels, pendulum_options().channels.states) << "the unit asked for";
  EXPECT_DOUBLE_EQ(target.dt, 1e-4);
  EXPECT_DOUBLE_EQ(target.rollouts[0].states(1, 0), 0.02);
  EXPECT_EQ(target.rollouts[0].actions(1, 0), -6.0);
}

CsvRows rows_at(const std::vector<double>& times) {
  CsvRows rows;
  rows.name = "a.csv";
  rows.times = times;
  const auto n = static_cast<Index>(times.size());
  rows.rollout = {"a", RowMatrix(n, 2), RowMatrix(n - 1, 1)};
  return rows;
}

// States that are linear in time, actions that count rows.
CsvRows ramp(const std::vector<double>& times) {
  CsvRows rows = rows_at(times);
  for (Index t = 0; t < std::ssize(times); ++t) {
    const double time = times[static_cast<std::size_t>(t)];
    rows.rollout.states.row(t) << 3.0 * time, 1.0 - time;
    if (t + 1 < std::ssize(times)) rows.rollout.actions(t, 0) = static_cast<double>(t);
  }
  return rows;
}

Rollout even(const std::vector<double>& times, double dt) {
  const CsvRows rows = ramp(times);
  return resampled(rows, rows.rollout, dt);
}

TEST(Resample, AnActionActsForAsLongAsItWasHeld) {
  const RowMatrix found = even({0.0, 0.13, 0.19, 0.32, 0.4}, 0.1).actions;
  EXPECT_LT((found - RowMatrix{{0.0}, {0.8}, {2.0}, {2.8}}).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(even({0.0, 0.1, 0.2, 0.3, 0.4}, 0.2).actions.rows(), 2);
  const RowMatrix twice = even({0.0, 0.4, 0.8}, 0.2).actions;
  EXPECT_LT((twice - RowMatrix{{0}, {0}, {1}, {1}}).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Resample, RoundedTimesOfAnEvenClockKeepEveryRow) {
  std::vector<double> times;
  for (int t = 0; t <= 90; ++t) times.push_back(std::round(1000.0 * t / 30.0) / 1000.0);
  const CsvRows rows = ramp(times);
  const Rollout found = even(times, 1.0 / 30.0);
  ASSERT_EQ(found.actions.rows(), 90);
  EXPECT_LT((found.actions - rows.rollout.actions).cwiseAbs().maxCoeff(), 0.031);  // 2 x .5 ms
  EXPECT_LT((found.states - rows.rollout.states).cwiseAbs().maxCoeff(), 3.0 * 0.0006);
}

// A line between samples h apart is at most h^2 / 8 times the second derivative off.
TEST(Resample, TheErrorOfALineIsItsCurvature) {
  std::vector<double> times = {0.0};
  Stream stream({1, "clock", 0, 0, 0});
  while (times.back() < 4.0) times.push_back(times.back() + 0.01 * (0.5 + stream.uniform()));
  CsvRows rows = rows_at(times);
  for (Index t = 0; t < rows.rollout.states.rows(); ++t) {
    rows.rollout.states.row(t).setConstant(std::sin(5.0 * times[static_cast<std::size_t>(t)]));
  }
  rows.rollout.actions.setZero();
  const Rollout found = resampled(rows, rows.rollout, 0.01);
  for (Index t = 0; t < found.states.rows(); ++t) {
    EXPECT_NEAR(found.states(t, 0), std::sin(0.05 * static_cast<double>(t)),
                25.0 * 0.015 * 0.015 / 8.0);
  }
}

TEST(Resample, AStepThatFillsTheMemoryIsRefused) {
  for (const auto& [dt, said] :
       {std::pair{1e-9, "a.csv: --resample 1e-09 makes 1e+08 steps of 2 rows"},
        {1e-300, "a.csv: --resample 1e-300 makes 1e+299 steps of 2 rows"}}) {
    const auto refused = [dt = dt] { even({0.0, 0.1}, dt); };
    EXPECT_TRUE(says(message_of<InputError>(refused), {said, "must make 1 to 2000"}));
  }
  EXPECT_EQ(even({0.0, 0.1}, 0.1 / 2000.0).actions.rows(), 2000);
}

Target target_of(const std::vector<Index>& lengths) {
  Target target{0.1, {{"x", "m"}}, {{"u", "V"}}, {}, "test"};
  for (const Index length : lengths) {
    const std::string name = target.rollouts.empty() ? "a" : "b";
    target.rollouts.push_back(
        {name, Vector::LinSpaced(length + 1, 0.0, 1.0), Vector::Ones(length)});
  }
  return target;
}

TEST(RolloutLength, IsCutIntoPiecesOfTheShortestOrANumber) {
  Target target = target_of({5, 3});
  EXPECT_EQ(
      texts_of(cut_rollouts(target, 0)),
      std::vector<std::string>{
          "cut into rollouts of 3 steps: 1 of a (2 steps dropped), 1 of b (0 steps dropped)"});
  target.check("x");
  EXPECT_EQ(target.num_steps(), 3);
  EXPECT_EQ(target.rollouts[0].name, "a");
  EXPECT_DOUBLE_EQ(target.rollouts[0].states(3, 0), 0.6) << "the first steps are kept";

  Target long_one = target_of({5, 3});
  cut_rollouts(long_one, 2);
  long_one.check("x");
  ASSERT_EQ(long_one.num_rollouts(), 3);
  EXPECT_EQ(long_one.rollouts[1].name, "a.2");
  EXPECT_EQ(long_one.rollouts[2].name, "b");
  const RowMatrix second = Vector{{0.4, 0.6, 0.8}};
  EXPECT_TRUE(long_one.rollouts[1].states.isApprox(second)) << "it begins where the first one ends";
  Target equal = target_of({3, 3});
  EXPECT_TRUE(cut_rollouts(equal, {}).empty());
}

}  // namespace
}  // namespace npdr::pipeline
