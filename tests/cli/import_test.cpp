/// `npdr import` of what labs record: each file is refused with the option that helps, and that
/// option helps.
#include <fmt/format.h>

#include <cmath>

#include "core/random.h"
#include "core/text.h"
#include "pipeline/artefacts/recording.h"
#include "sim/simulator.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

// How a lab writes a rollout of a pendulum that swings.
struct Lab {
  std::string separator = ",";
  bool decimal_comma = false;
  bool has_rates = true;
  bool wraps = false;
  double jitter = 0.0;  // of a step of 0.02 s, as a part of it
  double factor = 1.0;  // of the angle
  double clock = 1.0;   // seconds of the lab in one second
  int count = 201;      // rows
};

std::string csv_of(const Lab& lab, double amplitude) {
  std::vector<std::string> head = {"t [s]", "theta [rad]", "theta_dot [rad/s]", "torque [N m]"};
  if (!lab.has_rates) head.erase(head.begin() + 2);
  std::string text = join(head, lab.separator) + "\n";
  Stream stream({1, "clock", 0, 0, 0});
  for (int i = 0; i < lab.count; ++i) {
    const double t = 0.02 * (i + lab.jitter * (stream.uniform() - 0.5));
    const double angle = 3.0 + amplitude * std::sin(3.0 * t);
    std::vector<std::string> row = {
        fmt::format("{:.6f}", t * lab.clock),
        fmt::format("{:.6f}", lab.factor * (lab.wraps ? std::remainder(angle, 2.0 * M_PI) : angle)),
        fmt::format("{:.6f}", 3.0 * amplitude * std::cos(3.0 * t)), fmt::format("{:.3f}", 0.1 * i)};
    if (!lab.has_rates) row.erase(row.begin() + 2);
    std::string line = join(row, lab.separator) + "\n";
    if (lab.decimal_comma) std::ranges::replace(line, '.', ',');
    text += line;
  }
  return text;
}

class ImportOfLabs : public ::testing::Test {
 protected:
  ImportOfLabs() { write({}); }

  void write(const Lab& lab) const {
    folder_.file("a.csv", csv_of(lab, 0.5));
    folder_.file("b.csv", csv_of(lab, 0.8));
  }

  Outcome import(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"npdr",     "import", "a.csv", "b.csv",  "--simulator",
                                      "pendulum", "-o",     "r.h5",  "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_.path(), words);
  }

  // The message of an import that leaves nothing behind.
  std::string rejected(const std::vector<std::string>& more) const {
    std::filesystem::remove(folder_ / "r.h5");
    const Outcome outcome = import(more);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(files_ending(folder_.path(), ".h5").empty());
    EXPECT_TRUE(temporaries(folder_.path()).empty());
    return outcome.err;
  }

  std::string imported(const std::vector<std::string>& more) const {
    const Outcome outcome = import(more);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  }

  Target target() const { return read_recording(folder_ / "r.h5"); }

  TempFolder folder_;
};

TEST_F(ImportOfLabs, SaysWhatWasCheckedAndWhatIsNext) {
  EXPECT_TRUE(says(imported({}), {"checked: theta_dot is the slope of theta", "%",
                                  "\nwrote r.h5: 2 rollouts of 200 steps of 0.02 s",
                                  "\nnext: npdr run STUDY.toml --set target.recording=r.h5"}));
}

TEST_F(ImportOfLabs, HelpHasAnExample) {
  const Outcome help = run(folder_.path(), {"npdr", "import", "--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* part :
       {"--differentiate", "--no-rate-check", "Example", "npdr import run*.csv"}) {
    EXPECT_NE(help.out.find(part), std::string::npos) << part;
  }
}

TEST_F(ImportOfLabs, DecimalCommas) {
  write({.separator = ";", .decimal_comma = true});
  EXPECT_TRUE(says(rejected({}), {"npdr import: a.csv:1: column 1 is headed", "';'",
                                  "--delimiter ';' --decimal-comma"}));
  EXPECT_TRUE(says(rejected({"--delimiter", ";"}),
                   {"npdr import: a.csv:2: column 2 'theta' = '3,000000'", "--decimal-comma"}));
  EXPECT_TRUE(says(rejected({"--decimal-comma"}), {"npdr import: --decimal-comma", "--delimiter"}));
  EXPECT_TRUE(says(rejected({"--delimiter", "x"}),
                   {"npdr import: --delimiter = 'x'", "must be ',', ';', '|' or tab"}));
  imported({"--delimiter", ";", "--decimal-comma"});
  EXPECT_NEAR(target().rollouts[0].states(0, 1), 1.5, 1e-9);
  write({.separator = "\t"});
  EXPECT_TRUE(says(rejected({}), {"npdr import: a.csv:1:", "tabs: add --delimiter tab"}));
  imported({"--delimiter", "tab"});
}

TEST_F(ImportOfLabs, EncodersAlone) {
  write({.has_rates = false});
  EXPECT_TRUE(says(rejected({}), {"npdr import: a.csv:1: has no column 'theta_dot'",
                                  "--differentiate computes it of 'theta'"}));
  EXPECT_TRUE(says(imported({"--differentiate"}),
                   {"computed theta_dot: slope of theta over 11 samples, 0.2 s",
                    "\nnot checked: units", "\nwrote r.h5", "\nnext: "}));
  EXPECT_NEAR(target().rollouts[0].states(100, 1), 1.5 * std::cos(6.0), 1e-3);
  EXPECT_NE(imported({"--differentiate=5"}).find("over 5 samples"), std::string::npos);
  EXPECT_TRUE(says(imported({"--unwrap", "theta", "--differentiate"}),
                   {"unwrapped", "\ncomputed", "\nnot checked", "\nwrote", "\nnext"}));
}

TEST_F(ImportOfLabs, NothingCountsTwiceAndNothingElseIsReplaced) {
  write({});
  EXPECT_TRUE(says(rejected({"a.csv"}), {"npdr import: a.csv: is named twice"}));
  folder_.file("copy.csv", text_of(folder_ / "b.csv"));
  EXPECT_TRUE(says(rejected({"copy.csv"}),
                   {"npdr import: copy.csv: holds the same numbers as b.csv", "name each"}));
  const Outcome labels = run(folder_.path(), {"npdr", "import", "a.csv", "-o", "new.h5", "--states",
                                              "theta [rad]", "--actions", "theta [rad]"});
  EXPECT_EQ(labels.status, 2);
  EXPECT_TRUE(says(labels.err, {"npdr import: --states and --actions: 'theta' is named twice"}));
  EXPECT_TRUE(says(rejected({"--at-rest"}), {"npdr import: --at-rest is about rates"}));
  const auto program = folder_.file("r.h5", "#!/bin/sh\n");
  EXPECT_TRUE(says(import({"--force"}).err, {"npdr import: r.h5: isn't an HDF5 file"}));
  EXPECT_EQ(text_of(program), "#!/bin/sh\n");
}

TEST_F(ImportOfLabs, LinksStayLinks) {
  write({});
  std::filesystem::create_directory(folder_ / "big");
  std::filesystem::create_symlink("big/real.h5", folder_ / "r.h5");
  EXPECT_EQ(import({}).status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "r.h5"));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / "big/real.h5"));
  const auto refused = [&](const std::string& output) {
    return run(folder_.path(), {"npdr", "import", "a.csv", "-o", output}).err;
  };
  EXPECT_TRUE(says(refused("r.h5"), {"npdr import: big/real.h5: is there already"}));
  EXPECT_TRUE(
      says(refused("out.CSV"), {"npdr import: out.CSV: is to hold HDF5, must not end in .csv"}));
}

TEST_F(ImportOfLabs, WindowsAreOddNumbers) {
  write({.has_rates = false});
  for (const char* word : {"--differentiate=4", "--differentiate=3", "--differentiate=x"}) {
    EXPECT_TRUE(says(rejected({word}), {"npdr import: " + std::string(word),
                                        "must be an odd number of samples, 5 or more"}));
  }
  EXPECT_TRUE(says(rejected({"--differentiate", "21"}),
                   {"npdr import: 21: isn't there", "write --differentiate=21"}));
  EXPECT_TRUE(says(rejected({"--differentiate=301"}),
                   {"npdr import: a.csv: has 201 states", "must have 301 or more"}));
}

TEST_F(ImportOfLabs, ClocksThatJitter) {
  write({.jitter = 0.6});
  EXPECT_TRUE(says(rejected({}), {"npdr import: a.csv:", "column 1 't' is", "equally spaced",
                                  "its steps are", "--resample"}));
  EXPECT_TRUE(says(
      imported({"--resample", "0.02"}),
      {"resampled to 0.02 s: steps were", "\nchecked", "\nwrote", "steps of 0.02 s", "\nnext"}));
  const RowMatrix states = target().rollouts[0].states;
  // The grid begins at the first time, which is up to 0.3 steps off; the angle's rate is 1.5 rad/s.
  EXPECT_NEAR(states(100, 0), 3.0 + 0.5 * std::sin(6.0), 0.3 * 0.02 * 1.5 + 1e-3);
  EXPECT_TRUE(says(rejected({"--resample", "0"}), {"npdr import: --resample = 0", "> 0"}));
}

TEST_F(ImportOfLabs, GapsAreTold) {
  write({});
  for (const char* file : {"a.csv", "b.csv"}) {  // three of four lines are lost in the middle
    EXPECT_EQ(
        std::system(fmt::format("cd '{}' && awk 'NR < 40 || NR > 100 || NR % 4 == 0' {} > cut "
                                "&& mv cut {}",
                                folder_.path().string(), file, file)
                        .c_str()),
        0);
  }
  EXPECT_NE(imported({"--resample", "0.02"}).find("warning: a.csv: "), std::string::npos);
  EXPECT_NE(imported({"--resample", "0.02"}).find("straight lines there"), std::string::npos);
}

TEST_F(ImportOfLabs, AnglesThatWrap) {
  write({.wraps = true});
  EXPECT_TRUE(says(rejected({}), {"npdr import: a.csv:", "theta jumps by", "such jumps in 2 files",
                                  "--unwrap theta", "\n--no-rate-check"}));
  EXPECT_TRUE(says(imported({"--unwrap", "theta"}),
                   {"unwrapped theta: ", "\nchecked", "\nwrote", "\nnext"}));
  EXPECT_TRUE(says(imported({"--no-rate-check"}), {"wrote r.h5", "\nnext"}));
}

TEST_F(ImportOfLabs, AnglesInDegrees) {
  write({.factor = 180.0 / M_PI});
  EXPECT_TRUE(
      says(rejected({}), {"npdr import: theta changes 57.3 times as fast as theta_dot says",
                          "degrees", "[rad]", "--scale theta=0.0174533", "\n--no-rate-check"}));
  imported({"--scale", "theta=0.0174533"});
  EXPECT_NEAR(target().rollouts[0].states(0, 0), 3.0, 1e-5);
  for (const char* word : {"theta", "theta=", "theta=x", "=2", "theta=0"}) {
    EXPECT_TRUE(says(rejected({"--scale", word}),
                     {"npdr import: --scale " + std::string(word), "must be COLUMN=FACTOR"}));
  }
  EXPECT_TRUE(says(rejected({"--scale", "theta=2", "--scale", "theta=3"}),
                   {"npdr import: --scale: column 'theta' has two factors"}));
}

TEST_F(ImportOfLabs, AWrongClock) {
  write({.clock = 2.0});
  EXPECT_TRUE(says(rejected({}), {"npdr import: theta changes 0.5 times as fast as theta_dot says",
                                  "dt is probably 0.04 * 0.5 = 0.02 s", "--scale t=0.5",
                                  "--scale theta_dot=0.5", "\n--no-rate-check"}));
  imported({"--scale", "t=0.5"});
  EXPECT_DOUBLE_EQ(target().dt, 0.02);
}

TEST_F(ImportOfLabs, RolloutsOfDifferentLengths) {
  folder_.file("b.csv", csv_of({.count = 151}, 0.8));
  EXPECT_TRUE(says(rejected({}), {"npdr import: b.csv: has 151 rows", "the first file has 201",
                                  "--length shortest or --length STEPS"}));
  EXPECT_TRUE(says(imported({"--length", "shortest"}),
                   {"checked", "\ncut into rollouts of 150 steps: 1 of a (50 steps dropped)",
                    "1 of b (0 steps dropped)", "\nwrote", "150 steps", "\nnext"}));
  EXPECT_NE(
      imported({"--length", "100"}).find("2 of a (0 steps dropped), 1 of b (50 steps dropped)"),
      std::string::npos);
  EXPECT_EQ(target().num_rollouts(), 3);
  EXPECT_TRUE(says(rejected({"--length", "180"}),
                   {"npdr import: --length 180: b.csv has 150 steps", "at least as many"}));
  for (const char* word : {"0", "-1", "longest"}) {
    EXPECT_TRUE(says(rejected({std::string("--length=") + word}),
                     {"npdr import: --length", "must be 'shortest' or a number of steps"}));
  }
}

TEST_F(ImportOfLabs, DatasetsKnowTheFormatButNoMotion) {
  folder_.file("theta.csv", "mass [kg];length [m]\n1,5;2\n2,5;3\n");
  folder_.file("x.csv", "1,25\n2,25\n");
  const auto dataset = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"npdr", "import", "--theta", "theta.csv",
                                      "--x",  "x.csv",  "-o",      "d.h5"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_.path(), words);
  };
  EXPECT_TRUE(says(dataset({}).err, {"npdr import: theta.csv:2: has 2 columns", "must have 1",
                                     "--delimiter ';' --decimal-comma"}));
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"--differentiate"}, {"--resample", "1"}, {"--length", "3"}, {"--no-rate-check"}}) {
    const Outcome outcome = dataset(words);
    EXPECT_EQ(outcome.status, 2) << words[0];
    EXPECT_TRUE(says(outcome.err, {"npdr import: --theta and --x make a dataset", "leave out"}));
  }
  const Outcome outcome = dataset({"--delimiter", ";", "--decimal-comma"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(
      says(dataset({"--delimiter", ";", "--decimal-comma", "--force"}).out, {"wrote", "\nnext"}));
  folder_.file("x.csv", "1,25\n2,2");
  EXPECT_TRUE(says(dataset({"--delimiter", ";", "--decimal-comma", "--force"}).out,
                   {"warning: x.csv: its last line has no end", "\nwrote d.h5", "\nnext"}));
  EXPECT_TRUE(says(outcome.out, {"wrote d.h5: 2 rows",
                                 "\nnext: npdr new NAME --dataset d.h5; npdr run STUDY.toml --set "
                                 "simulator.dataset=d.h5"}));
}

}  // namespace
}  // namespace npdr::pipeline
