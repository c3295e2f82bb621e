#include "pipeline/import/csv_import.h"

#include <fmt/format.h>

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

}  // namespace
}  // namespace npdr::pipeline
