#include "pipeline/import/csv_import.h"

#include <fmt/format.h>

#include <cmath>

#include "tests/pipeline/import/csv_files.h"

namespace npdr::pipeline {
namespace {

class CsvImport : public CsvFiles {};

TEST_F(CsvImport, ReadsStatesAndActionsInTheSimulatorsOrder) {
  const Target target = imported(kCsv);
  EXPECT_DOUBLE_EQ(target.dt, 0.1);
  EXPECT_EQ(target.state_channels, pendulum_options().channels.states);
  EXPECT_EQ(target.num_steps(), 2);
  EXPECT_EQ(target.rollouts[0].name, "a");
  EXPECT_EQ(target.source, "a.csv");
  EXPECT_EQ(target.rollouts[0].states, (RowMatrix{{0.1, 1}, {0.2, 2}, {0.3, 3}}));
  EXPECT_EQ(target.rollouts[0].actions, (RowMatrix{{5}, {6}})) << "the last action is ignored";
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
  EXPECT_EQ(notes(kCsv, options).front(),
            "not imported: torque; --states and --actions name what is");
  EXPECT_EQ(join(notes(kCsv, pendulum_options())).find("not imported"), std::string::npos);
}

TEST_F(CsvImport, ReadsWhatSpreadsheetsWrite) {
  const Target target = imported(
      "\xEF\xBB\xBF\"time [s]\", theta [rad] ,\"theta_dot [rad/s]\",torque [N m]\r\n"
      "0,\"0.1\", +1e0 ,5\r\n1e-1,.2,2,6\r\n0.2,0.3,3,\r\n\r\n  \r\n");
  EXPECT_EQ(target.rollouts[0].states, (RowMatrix{{0.1, 1}, {0.2, 2}, {0.3, 3}}));
  EXPECT_EQ(target.rollouts[0].actions, (RowMatrix{{5}, {6}}));
}

TEST_F(CsvImport, AQuotedHeaderMayHoldCommasAndQuotes) {
  const CsvOptions options = {.channels = {{{"a, \"b\"", ""}}, {}}, .dt = 0.5, .source = ""};
  EXPECT_EQ(imported("\"a, \"\"b\"\" [m]\"\n1\n2\n", options).state_channels[0].unit, "m");
}

TEST_F(CsvImport, JoinsFilesAsRollouts) {
  const Target target = import_csv({folder_.file("a.csv", kCsv),
                                    folder_.file("b.csv", replaced(kCsv, "0.2,0.3", "0.2,0.4"))},
                                   pendulum_options())
                            .target;
  EXPECT_EQ(target.num_rollouts(), 2);
  EXPECT_EQ(target.rollouts[1].name, "b");
  EXPECT_EQ(target.source, "a.csv, b.csv");
}

TEST_F(CsvImport, FilesOfOneNameAreToldApartByTheirFolders) {
  for (const char* day : {"monday", "friday"}) {
    std::filesystem::create_directory(folder_ / day);
  }
  const Target target =
      import_csv({folder_.file("monday/run.csv", kCsv),
                  folder_.file("friday/run.csv", replaced(kCsv, "0.2,0.3", "0.2,0.4"))},
                 pendulum_options())
          .target;
  EXPECT_EQ(target.rollouts[0].name, "monday/run");
  EXPECT_EQ(target.rollouts[1].name, "friday/run");
}

TEST_F(CsvImport, FilesMustBeAlike) {
  const auto second = [&](const std::string& text, const CsvOptions& options) {
    return message_of<InputError>(
        [&] {
          import_csv({folder_.file("a.csv", kCsv), folder_.file("b.csv", text)}, options);
        },
        &folder_);
  };
  EXPECT_TRUE(says(second(replaced(kCsv, "0.2,0.3,3,7\n", ""), pendulum_options()),
                   {"b.csv: has 2 rows", "the first file has 3", "cut them to one length",
                    "--length shortest"}));
  EXPECT_TRUE(
      says(second("t [s],theta [rad],theta_dot [rad/s],torque [N m]\n0,1,1,1\n1,1,1,1\n2,1,1,1\n",
                  pendulum_options()),
           {"b.csv: its times are 1 s apart", "0.1 s", "--resample 1"}));
  const CsvOptions any_unit = {.channels = {{{"theta", ""}}, {}}, .dt = {}, .source = ""};
  EXPECT_TRUE(says(second(replaced(kCsv, "[rad]", "[deg]"), any_unit),
                   {"b.csv: states are theta [deg]", "must be theta [rad]",
                    "only units differ, theta [deg] in place of [rad]; convert its values"}));
}

TEST_F(CsvImport, KnowsAClockByItsUnitAndName) {
  const auto with_clock = [](const std::string& name) { return replaced(kCsv, "t [s]", name); };
  for (const char* name : {"Time [s]", "ros_timestamp [s]", "Zeit [s]", "T [s]"}) {
    EXPECT_EQ(imported(with_clock(name), pendulum_options()).dt, 0.1) << name;
  }
  CsvOptions options = pendulum_options();
  for (const char* name : {"Zeit [ms]", "latency [s]"}) {
    EXPECT_TRUE(says(problem(with_clock(name), options), {"a.csv:1: no column 't [s]'"})) << name;
  }
  options.dt = 0.2;
  EXPECT_TRUE(says(problem(with_clock("Zeit [s]"), options),
                   {"a.csv: its times are 0.1 s apart, but --dt says 0.2 s"}));
}

TEST_F(CsvImport, TakesTheTimeStepFromTheOptionWithoutATimeColumn) {
  CsvOptions options = pendulum_options();
  const std::string text = replaced(kCsv, "t [s]", "row [1]");
  EXPECT_TRUE(says(problem(text), {"a.csv:1: no column 't [s]' or 'time [s]'",
                                   "give the time between two rows with --dt"}));
  options.dt = 0.02;
  EXPECT_EQ(imported(text, options).dt, 0.02);
  EXPECT_TRUE(
      says(problem(kCsv, options), {"a.csv: its times are 0.1 s apart", "--dt says 0.02 s"}));
  options.dt = 0.1;
  EXPECT_EQ(imported(kCsv, options).dt, 0.1);
  for (const double dt : {0.0, -0.1}) {
    options.dt = dt;
    EXPECT_EQ(problem(kCsv, options), fmt::format("--dt = {}, must be a time > 0 [s]", dt));
  }
}

TEST_F(CsvImport, TimesMustBeEquallySpaced) {
  EXPECT_EQ(imported(replaced(kCsv, "0.1,0.2", "0.103,0.2")).num_steps(), 2) << "rounded times";
  const std::string more = kCsv + "0.3,0.4,4,8\n0.4,0.5,5,9\n0.5,0.6,6,10\n";
  EXPECT_TRUE(
      says(problem(replaced(more, "0.3,0.4,4,8\n", "")),
           {"a.csv:5: column 1 't' is 0.2 after the line before, elsewhere 0.1: times",
            "must be equally spaced and increase", "its steps are 0.1 to 0.2 s", "--resample 0.1"}))
      << "a lost line";
  EXPECT_TRUE(says(problem(replaced(kCsv, "0.2,0.3", "0.0,0.3")),
                   {"a.csv:4: column 1 't' is -0.1 after the line before, elsewhere 0.1: times",
                    "must be equally spaced and increase"}));
  EXPECT_TRUE(says(problem(replaced(kCsv, "t [s]", "t [ms]")),
                   {"a.csv:1: column 1 't' is in [ms]", "must be in [s]", "--scale t=0.001"}));
}

TEST_F(CsvImport, ChecksLabelsAndUnitsOfTheHeader) {
  EXPECT_TRUE(
      says(problem(replaced(kCsv, "theta [rad]", "thet [rad]")),
           {"a.csv:1: has no column 'theta'", "'thet'", "it has t, thet, theta_dot, torque"}));
  EXPECT_TRUE(says(problem(replaced(kCsv, "[rad]", "[deg]")),
                   {"a.csv:1: column 2 'theta' is in [deg]", "must be in [rad]",
                    "--scale theta=0.0174533 converts it"}));
  EXPECT_TRUE(says(problem(replaced(kCsv, "theta [rad]", "theta")),
                   {"a.csv:1: column 2 is headed 'theta'", "must be 'label [unit]'",
                    "'theta [rad]'", "'gain [1]'"}));
  EXPECT_EQ(problem(replaced(kCsv, "theta_dot [rad/s]", "theta [rad]")),
            "a.csv:1: column 3 is a second one headed 'theta'");
  EXPECT_EQ(problem("1,2,3\n4,5,6\n").substr(0, 33), "a.csv:1: column 1 is headed '1', ");
}

TEST_F(CsvImport, AUnitIsTheLastBracketsAfterABlank) {
  const CsvOptions options = {
      .channels = {{{"x[0]", "m"}, {"x[1] [old]", ""}}, {}}, .dt = 0.5, .source = ""};
  const std::string text = "x[0] [m],x[1] [old] [mm]\n1,2\n3,4\n";
  EXPECT_EQ(imported(text, options).state_channels,
            (std::vector<Channel>{{"x[0]", "m"}, {"x[1] [old]", "mm"}}));
  EXPECT_EQ(problem(replaced(text, "x[0] [m]", "x[0]"), options),
            "a.csv:1: column 1 is headed 'x[0]', must be 'label [unit]', such as 'theta [rad]' or "
            "'gain [1]', with commas between columns");
}

TEST_F(CsvImport, NamesLineAndColumnOfWhatIsntANumber) {
  const std::string must =
      ", must be a finite number: cut the rollout there or, where there are times, remove the row "
      "and pass --resample DT";
  EXPECT_EQ(problem(replaced(kCsv, "0.2,2", "0.2,two")),
            "a.csv:3: column 3 'theta_dot' = 'two'" + must);
  EXPECT_EQ(problem(replaced(kCsv, "0.2,2", "nan,2")), "a.csv:3: column 2 'theta' = 'nan'" + must);
  EXPECT_EQ(problem(replaced(kCsv, "0.2,2", "inf,2")), "a.csv:3: column 2 'theta' = 'inf'" + must);
  EXPECT_EQ(problem(replaced(kCsv, "0.2,2", "1e999,2")),
            "a.csv:3: column 2 'theta' = '1e999'" + must);
  EXPECT_EQ(problem(replaced(kCsv, "0.2,2", ",2")), "a.csv:3: column 2 'theta' = ''" + must);
  EXPECT_EQ(problem(replaced(kCsv, "0.2,2", "0.2 0,2")),
            "a.csv:3: column 2 'theta' = '0.2 0'" + must);
  EXPECT_EQ(problem(replaced(kCsv, "2,6", "2,")), "a.csv:3: column 4 'torque' = ''" + must)
      << "only the last row may lack an action";
  EXPECT_EQ(problem(replaced(kCsv, "3,7", "3,x")), "a.csv:4: column 4 'torque' = 'x'" + must);
}

TEST_F(CsvImport, RaggedAndBrokenFilesAreRefused) {
  EXPECT_TRUE(
      says(problem(replaced(kCsv, "2,6\n", "2\n")), {"a.csv:3: has 3 columns", "must have 4"}));
  EXPECT_TRUE(says(problem(replaced(kCsv, "2,6\n", "2,6\n\n")),
                   {"a.csv:4: is empty", "rows follow", "remove it"}));
  EXPECT_EQ(problem(replaced(kCsv, "2,6\n", "2,\"6\n")), "a.csv:3: column 4 has no closing quote");
  EXPECT_EQ(problem(""), "a.csv: is empty");
  EXPECT_TRUE(says(problem(kCsv.substr(0, kCsv.find("0.1,0.2"))),
                   {"a.csv: has 1 row below its header", "must have at least 2"}));
  EXPECT_TRUE(says(problem("t [s];theta [rad]\n0;1\n1;1\n"),
                   {"a.csv:1: column 1 is headed 't [s];theta [rad]'", "must be 'label [unit]'",
                    "'theta [rad]'", "'gain [1]'", "--delimiter ';'"}));
}

TEST_F(CsvImport, FilesThatCantBeReadAreNamed) {
  const auto reading = [&](const std::filesystem::path& path) {
    return message_of<InputError>([&] { import_csv({path}, pendulum_options()); }, &folder_);
  };
  EXPECT_EQ(reading(folder_ / "b.csv"), "b.csv: isn't there");
  std::filesystem::create_directory(folder_ / "c.csv");
  EXPECT_EQ(reading(folder_ / "c.csv"), "c.csv: is a folder, must be a file");
  EXPECT_EQ(message_of<InputError>([&] { import_csv({}, pendulum_options()); }),
            "no CSV files to import");
  EXPECT_EQ(problem(kCsv, {}), "no states to import: name their columns");
}

TEST_F(CsvImport, ReadsWhatOtherCountriesWrite) {
  CsvOptions options = pendulum_options();
  const std::string text =
      "t [s];theta [rad];theta_dot [rad/s];torque [N m]\n0;0,1;1;5\n0,1;0,2;2;6\n0,2;0,3;3;\n";
  EXPECT_TRUE(says(problem(text), {"a.csv:1: column 1 is headed", "separated by ';'",
                                   "add --delimiter ';' --decimal-comma"}));
  options.format = {';', true};
  EXPECT_EQ(imported(text, options).rollouts[0].states, imported(kCsv).rollouts[0].states);
  EXPECT_TRUE(
      says(problem(kCsv, options), {"a.csv:1: column 1 is headed", "with ';' between columns",
                                    "separated by commas: leave out --delimiter"}));
}

TEST_F(CsvImport, ScalesColumns) {
  CsvOptions options = pendulum_options();
  options.scales = {{"theta", 0.1}, {"t", 1e-3}, {"torque", -1.0}};
  const std::string text =
      replaced(replaced(kCsv, "theta [rad]", "theta [deg]"), "t [s]", "t [ms]");
  const Target target = imported(text, options);
  EXPECT_EQ(target.state_channels, pendulum_options().channels.states) << "the unit asked for";
  EXPECT_DOUBLE_EQ(target.dt, 1e-4);
  EXPECT_DOUBLE_EQ(target.rollouts[0].states(1, 0), 0.02);
  EXPECT_EQ(target.rollouts[0].actions(1, 0), -6.0);
  options.scales = {{"thet", 0.1}};
  EXPECT_TRUE(says(problem(kCsv, options),
                   {"a.csv: --scale: unknown column 'thet'", "'theta'", "theta_dot, torque, t"}));
}

// Positions of x^2 / 2, one a tenth of a second, without rates.
std::string encoder_csv(int count) {
  std::string text = "t [s],theta [rad],torque [N m]\n";
  for (int i = 0; i < count; ++i) {
    text += fmt::format("{:.1f},{:.6f},0\n", 0.1 * i, 0.005 * i * i);
  }
  return text;
}

TEST_F(CsvImport, ComputesRatesThatTheFileLacks) {
  CsvOptions options = pendulum_options();
  EXPECT_TRUE(says(problem(encoder_csv(20)), {"a.csv:1: has no column 'theta_dot'",
                                              "--differentiate computes it of 'theta'"}));
  options.differentiate = 5;
  const Target target = imported(encoder_csv(20), options);
  EXPECT_EQ(target.state_channels, pendulum_options().channels.states);
  for (Index t = 0; t < 20; ++t) {
    EXPECT_NEAR(target.rollouts[0].states(t, 1), 0.1 * static_cast<double>(t), 1e-4) << t;
  }
  const std::vector<std::string> said = notes(encoder_csv(20), options);
  ASSERT_EQ(said.size(), 2u) << "what was computed needs no check";
  EXPECT_TRUE(says(said[1], {"not checked: units, signs and the order of columns"}));
  EXPECT_TRUE(says(said[0], {"computed theta_dot: slope of theta", "5 samples", "0.4 s",
                             "at the first states, where simulations start, ", "--at-rest"}));
  options.at_rest = true;
  EXPECT_EQ(imported(encoder_csv(20), options).rollouts[0].states(0, 1), 0.0);
  EXPECT_TRUE(says(notes(encoder_csv(20), options)[0], {"computed", "0 at the first states"}));
  options.at_rest = false;
  options.channels = {{{"theta", ""}, {"theta_dot", ""}}, {}};
  EXPECT_EQ(imported(encoder_csv(20), options).state_channels, pendulum_options().channels.states)
      << "the unit follows from the file's";
}

TEST_F(CsvImport, ComputesOnlyWhatItCan) {
  CsvOptions options = pendulum_options();
  options.differentiate = 5;
  EXPECT_TRUE(says(problem(kCsv, options),
                   {"a.csv: has a column for every rate", "--differentiate", "leave it out"}));
  CsvOptions without_rate = options;
  without_rate.channels.states = {{"theta", "rad"}};
  EXPECT_TRUE(says(problem(encoder_csv(20), without_rate),
                   {"a.csv: --differentiate has nothing to compute", "no state is called X_dot",
                    "'theta_dot [rad/s]' of 'theta'"}));
  CsvOptions other_unit = options;
  other_unit.channels.states = {{"theta", "rad"}, {"theta_dot", "deg/s"}};
  EXPECT_TRUE(says(
      problem(encoder_csv(20), other_unit),
      {"a.csv:1: has no column 'theta_dot'", "computes it of 'theta' in [rad/s], not in [deg/s]"}));
  EXPECT_TRUE(says(problem(encoder_csv(4), options),
                   {"a.csv: has 4 states", "must have 5 or more", "--differentiate=5"}));
  EXPECT_TRUE(says(problem(replaced(encoder_csv(9), "theta [rad]", "alpha [rad]"), options),
                   {"a.csv:1: has no column 'theta'"}));
  EXPECT_TRUE(says(message_of<InputError>(
                       [&] {
                         import_csv(
                             {folder_.file("a.csv", encoder_csv(3)), folder_.file("b.csv", kCsv)},
                             options);
                       },
                       &folder_),
                   {"b.csv: must have columns for the same rates as", "a.csv"}));
  for (const Index window : {3, 6}) {
    options.differentiate = window;
    EXPECT_TRUE(says(problem(encoder_csv(20), options),
                     {fmt::format("--differentiate={}", window), "must be an odd number", "5"}));
  }
}

TEST_F(CsvImport, ResamplesClocksThatJitter) {
  CsvOptions options = pendulum_options();
  const std::string text = replaced(kCsv, "0.1,0.2,2", "0.12,0.22,2.2");
  EXPECT_TRUE(says(problem(text), {"a.csv:4: column 1 't' is 0.08 after the line before",
                                   "must be equally spaced", "0.08 to 0.12 s", "--resample 0.12"}));
  options.resample = 0.1;
  const Target target = imported(text, options);
  EXPECT_EQ(target.dt, 0.1);
  EXPECT_LT((target.rollouts[0].states - imported(kCsv).rollouts[0].states).norm(), 1e-12);
  EXPECT_EQ(target.rollouts[0].actions, (RowMatrix{{5}, {6}}));
  EXPECT_TRUE(says(notes(text, options).at(0), {"resampled to 0.1 s", "0.08 to 0.12 s"}));
  CsvOptions fine = options;
  fine.resample = 0.01;
  EXPECT_TRUE(says(notes(text, fine).at(1),
                   {"warning: --resample 0.01 is finer than the samples", "give 0.12", "or more"}));
}

TEST_F(CsvImport, ResamplesOnlyWhatHasTimes) {
  CsvOptions options = pendulum_options();
  options.resample = 0.1;
  EXPECT_TRUE(says(problem(replaced(kCsv, "t [s]", "row [1]"), options),
                   {"a.csv:1: no column 't [s]' or 'time [s]'", "--resample"}));
  EXPECT_TRUE(says(problem(replaced(kCsv, "0.1,0.2", "0.0,0.2"), options),
                   {"a.csv:3: column 1 't' is 0 after the line before", "must increase"}));
  EXPECT_TRUE(says(problem(kCsv + "9,0,0,0\n", options),
                   {"a.csv:5: column 1 't' is 8.8 after the line before", "at most 1", "cut"}));
  options.resample = 0.5;
  EXPECT_TRUE(says(problem(kCsv, options),
                   {"a.csv: --resample: lasts 0.2 s", "must be at least one step of 0.5 s"}));
  options.resample = -1.0;
  EXPECT_EQ(problem(kCsv, options), "--resample = -1, must be a time > 0 [s]");
  options.resample = 0.1;
  options.dt = 0.1;
  EXPECT_TRUE(says(problem(kCsv, options), {"--resample", "leave out --dt"}));
}

TEST_F(CsvImport, CutsRolloutsToOneLength) {
  CsvOptions options = pendulum_options();
  options.length = 0;
  const ImportedRecording recording = import_csv(
      {folder_.file("a.csv", kCsv + "0.3,0.4,4,8\n"), folder_.file("b.csv", kCsv)}, options);
  EXPECT_EQ(recording.target.num_steps(), 2);
  EXPECT_TRUE(says(recording.notes.back(), {"cut into rollouts of 2 steps", "1 of a (1 step"}));
}

TEST_F(CsvImport, WarnsOfAFileThatWasCut) {
  const std::string whole = kCsv;
  EXPECT_EQ(join(notes(whole, pendulum_options())).find("warning"), std::string::npos);
  EXPECT_TRUE(says(notes(whole.substr(0, whole.size() - 1), pendulum_options()).at(0),
                   {"warning: ", "a.csv: its last line has no end"}));
}

}  // namespace
}  // namespace npdr::pipeline
