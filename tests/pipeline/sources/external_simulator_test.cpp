#include "pipeline/sources/external_simulator.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/sources/source.h"
#include "pipeline/store/h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using sim::RolloutStatus;

// x = (2 a + k, seed), with rows whose a is in BAD doing something else. A line a call in `calls`.
constexpr const char* kScript = R"sh(
echo "$NPDR_FIRST_ROW $(wc -l < "$NPDR_SEEDS")" >> calls
exec awk -F, -v seeds="$NPDR_SEEDS" -v failed="$NPDR_FAILED" -v bad=" $BAD " -v what="$WHAT" '
  NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
  {
    getline seed < seeds
    a = $column["a"]
    if (what == "tires" && NR > 6) { print NR - 2, "tired" > failed; print "0,0"; next }
    if (index(bad, " " a " ")) {
      if (what == "crash") exit 9
      if (what == "hang") system("exec tail -f /dev/null")
      if (what == "text") { print "oops," seed; next }
      if (what == "nan") { print "nan," seed; next }
      if (what == "short") next
      if (what == "named") { print NR - 2, "a is", a > failed; print "0,0"; next }
    }
    printf "%.17g,%d\n", 2 * a + $column["k"], seed
  }' "$1" > "$2"
)sh";

class ExternalSimulators : public ::testing::Test {
 protected:
  ExternalSimulators() {
    folder_.file("sim.sh", kScript);
    study_.prior = {{"a", "1", inference::Marginal::Kind::uniform, 0.0, 100.0}};
    study_.simulator.parameters = {{"k", 0.5}};
    study_.external.folder = folder_.path();
    study_.external.features = {"y", "seed"};
    study_.external.start_time = 1.0;
    study_.external.retries = 0;
  }

  ExternalSimulator program(const std::string& command, Index hopeless = kHopelessRows) {
    study_.external.command = command;
    return {{study_.external, simulator_info(study_), feature_segments(2), 1, 2},
            folder_ / "log",
            hopeless};
  }

  // What is said where a program can't simulate rows of the parameters 0.
  static std::string error_of(ExternalSimulator& simulator, Index num_rows,
                              std::uint64_t first = 0) {
    return message_of<Error>([&] {
      simulator.simulate(RowMatrix::Zero(num_rows, 2), {1, "test", 0, first, 0});
    });
  }

  // Rows a = 0, 1, ..., n - 1 after a simulation with rows that do `what`.
  sim::Trajectories run(Index n, const std::string& bad, const std::string& what, Index begin = 0) {
    std::filesystem::remove(folder_ / "calls");
    ExternalSimulator simulator = program("BAD='" + bad + "' WHAT=" + what + " sh sim.sh");
    RowMatrix theta(n, 2);
    for (Index i = 0; i < n; ++i) theta.row(i) << static_cast<double>(begin + i), 0.5;
    return simulator.simulate(theta, {7, "test", 1, static_cast<std::uint64_t>(begin), 0});
  }

  Index num_calls() const {
    const std::string calls = text_of(folder_ / "calls");
    return std::ranges::count(calls, '\n');
  }

  static std::vector<Index> failed_rows(const sim::Trajectories& x, RolloutStatus status) {
    std::vector<Index> rows;
    for (Index i = 0; i < x.num_rows; ++i) {
      if (x.status[static_cast<std::size_t>(i)] != status) continue;
      rows.push_back(i);
      EXPECT_TRUE(std::isnan(x.row(i)[0]) && std::isnan(x.row(i)[1])) << i;
    }
    return rows;
  }

  // All rows but those have the values of a simulation without bad rows.
  void expect_others_as_ever(const sim::Trajectories& x) {
    const sim::Trajectories whole = run(x.num_rows, "", "none");
    for (Index i = 0; i < x.num_rows; ++i) {
      if (x.status[static_cast<std::size_t>(i)] != RolloutStatus::ok) continue;
      EXPECT_EQ(x.row(i)[0], whole.row(i)[0]) << i;
      EXPECT_EQ(x.row(i)[1], whole.row(i)[1]) << i;
    }
  }

  TempFolder folder_;
  Study study_;
};

TEST_F(ExternalSimulators, OneCallDoesAllRows) {
  const sim::Trajectories x = run(20, "", "none");
  EXPECT_EQ(text_of(folder_ / "calls"), "0 20\n");
  EXPECT_EQ(x.row(3)[0], 6.5f);
  EXPECT_NE(x.row(3)[1], x.row(4)[1]) << "each row has a seed of its own";
}

TEST_F(ExternalSimulators, SeedsBelongToRowsNotToCalls) {
  const sim::Trajectories whole = run(10, "", "none");
  const sim::Trajectories part = run(4, "", "none", 6);
  EXPECT_EQ(text_of(folder_ / "calls"), "6 4\n");
  for (Index i = 0; i < 4; ++i) EXPECT_EQ(part.row(i)[1], whole.row(6 + i)[1]);
}

TEST_F(ExternalSimulators, OnlyTheCulpritsOfACrashAreLost) {
  const sim::Trajectories x = run(40, "3 17 18 39", "crash");
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed), (std::vector<Index>{3, 17, 18, 39}));
  // 79 calls are the most that 40 rows can take, one for each half and row.
  EXPECT_LT(num_calls(), 40);
  expect_others_as_ever(x);
}

// Row 0 crashes, but for the third call, the first of it alone, which names it.
TEST_F(ExternalSimulators, ARowThatIsGivenUpIsNotAskedForAgain) {
  study_.external.retries = 1;
  ExternalSimulator simulator =
      program("BAD=0 WHAT=$(test $(wc -l < calls) = 2 && echo named || echo crash) sh sim.sh", 4);
  RowMatrix theta(6, 2);
  for (Index i = 0; i < 6; ++i) theta.row(i) << static_cast<double>(i), 0.5;
  const sim::Trajectories x = simulator.simulate(theta, {7, "test", 1, 0, 0});
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed), (std::vector<Index>{0}));
  EXPECT_EQ(num_calls(), 9) << "of 6, 6, 1, 1, 3, 1, 1, 2 and 3 rows";
}

TEST_F(ExternalSimulators, OnlyTheCulpritsOfABadFileAreLost) {
  const sim::Trajectories text = run(16, "5", "text");
  EXPECT_EQ(failed_rows(text, RolloutStatus::bad_output), (std::vector<Index>{5}));
  const sim::Trajectories fewer = run(16, "5", "short");
  EXPECT_EQ(failed_rows(fewer, RolloutStatus::bad_output), (std::vector<Index>{5}));
  expect_others_as_ever(fewer);
}

TEST_F(ExternalSimulators, OnlyTheCulpritOfAHangIsLost) {
  study_.external.time_limit = 2.0;
  study_.external.start_time = 1.5;  // enough for a shell on a busy machine
  const sim::Trajectories x = run(8, "6", "hang");
  EXPECT_EQ(failed_rows(x, RolloutStatus::timed_out), (std::vector<Index>{6}));
  expect_others_as_ever(x);
}

TEST_F(ExternalSimulators, ValuesThatAreNotFiniteAreADivergedRowWithoutAnotherCall) {
  const sim::Trajectories x = run(16, "5", "nan");
  EXPECT_EQ(failed_rows(x, RolloutStatus::diverged), (std::vector<Index>{5}));
  EXPECT_EQ(num_calls(), 1);
}

TEST_F(ExternalSimulators, RowsThatTheProgramNamesAreLostWithoutAnotherCall) {
  const sim::Trajectories x = run(16, "3 5 15", "named");
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed), (std::vector<Index>{3, 5, 15}));
  EXPECT_EQ(num_calls(), 1);
  expect_others_as_ever(x);
}

TEST_F(ExternalSimulators, ARowThatTheProgramNamesSaysWhy) {
  ExternalSimulator simulator =
      program("printf '0 too stiff\\n1  too  soft\\n' > $NPDR_FAILED; : {theta} {x}");
  const sim::Trajectories x = simulator.simulate(RowMatrix::Zero(2, 2), {1, "test", 0, 0, 0});
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed), (std::vector<Index>{0, 1}))
      << "where all rows have failed there need be no x";
  EXPECT_EQ(simulator.last_loss(), "too  soft");
  EXPECT_EQ(simulator.num_calls(), 1);
}

TEST_F(ExternalSimulators, NamedRowsAreAskedForOnceMoreInACallOfTheirOwn) {
  study_.external.retries = 1;
  const sim::Trajectories x = run(16, "3 5 15", "named");
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed), (std::vector<Index>{3, 5, 15}));
  EXPECT_EQ(text_of(folder_ / "calls"), "0 16\n3 3\n");
  expect_others_as_ever(x);
}

// As of a program whose memory is used up after so many rows.
TEST_F(ExternalSimulators, NamedRowsComeBackWhereTheCallWasToBlame) {
  study_.external.retries = 1;
  const sim::Trajectories x = run(16, "", "tires");
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed), std::vector<Index>());
  EXPECT_EQ(text_of(folder_ / "calls"), "0 16\n5 11\n10 6\n15 1\n");
  expect_others_as_ever(x);

  ExternalSimulator simulator = program("BAD= WHAT=tires sh sim.sh");
  simulator.simulate(RowMatrix::Zero(16, 2), {7, "test", 1, 0, 0});
  EXPECT_EQ(simulator.last_failure(), "tired");
  EXPECT_EQ(simulator.last_loss(), "") << "no row was lost to it";
}

TEST_F(ExternalSimulators, NamedRowsAreOneFailureOfAProgramThatAlwaysFails) {
  std::string bad;
  for (int a = 4; a < 100; ++a) bad += std::to_string(a) + " ";
  const std::string message = message_of<Error>([&] { run(100, "0 1 2 3 " + bad, "named"); });
  EXPECT_TRUE(has(message, "failed for each of 100 rows: a is 99"));
  EXPECT_EQ(num_calls(), 1);
  run(100, bad, "named");
  EXPECT_EQ(num_calls(), 2) << "with one for a row that went well: it does so still";
}

TEST_F(ExternalSimulators, ABadFileOfNamesIsABadOutput) {
  ExternalSimulator simulator =
      program("echo all > $NPDR_FAILED; printf '1,2\\n' > {x}; : {theta}");
  const sim::Trajectories x = simulator.simulate(RowMatrix::Zero(1, 2), {1, "test", 0, 0, 0});
  EXPECT_EQ(failed_rows(x, RolloutStatus::bad_output), std::vector<Index>{0});
  EXPECT_TRUE(simulator.last_failure().starts_with("NPDR_FAILED has in line 1 'all', must have"))
      << simulator.last_failure();
}

TEST_F(ExternalSimulators, ARowThatDivergesSaysWhichNumberIsNone) {
  ExternalSimulator simulator = program("WHAT=nan BAD=5 sh sim.sh");
  RowMatrix theta = RowMatrix::Zero(16, 2);
  theta.col(0).setLinSpaced(0.0, 15.0);
  simulator.simulate(theta, {1, "test", 0, 0, 0});
  EXPECT_EQ(simulator.lost_number(), "row 5 has nan in 'y'");
}

TEST_F(ExternalSimulators, SmallerCallsHaveTheirShareOfTheTimeLimit) {
  study_.external.time_limit = 100.0;
  study_.external.start_time = 2.0;
  const ExternalSimulator simulator = program("sim");
  EXPECT_DOUBLE_EQ(simulator.time_limit(1000, 1000), 100.0);
  EXPECT_DOUBLE_EQ(simulator.time_limit(250, 1000), 27.0);
  EXPECT_DOUBLE_EQ(simulator.time_limit(999, 1000), 100.0);
  EXPECT_DOUBLE_EQ(simulator.time_limit(1, 1), 100.0);
}

TEST_F(ExternalSimulators, AProgramThatIsNotThereIsAnErrorAtOnce) {
  ExternalSimulator simulator = program("nosuchprogram");
  EXPECT_TRUE(has(error_of(simulator, 100),
                  {"simulator.command = 'nosuchprogram' can't be run: exit status 127",
                   "nosuchprogram: not found"}));
  EXPECT_EQ(simulator.num_calls(), 1);
}

TEST_F(ExternalSimulators, AProgramThatAlwaysFailsIsAnErrorAfterSomeRows) {
  ExternalSimulator simulator = program("echo no license >&2; exit 5 #");
  EXPECT_TRUE(
      has(error_of(simulator, 1000), {"failed for each of 32 rows: exit status 5", "no license"}));
  EXPECT_LT(simulator.num_calls(), 100);
}

TEST_F(ExternalSimulators, FewerRowsAreHopelessWhereFewMayFail) {
  EXPECT_EQ(hopeless_rows(0.0), 4);
  EXPECT_EQ(hopeless_rows(0.05), 7);
  EXPECT_EQ(hopeless_rows(0.5), 30);
  EXPECT_EQ(hopeless_rows(0.95), 405);
  EXPECT_EQ(hopeless_rows(1.0), std::numeric_limits<Index>::max());
  ExternalSimulator simulator = program("echo 1,2,3 >{x} #", hopeless_rows(0.05));
  EXPECT_TRUE(has(error_of(simulator, 64),
                  {"failed for each of 7 rows: ", "has 3 columns, must have 2: y, seed"}));
  EXPECT_EQ(simulator.num_calls(), 8);
}

// However the first call fails: one good row of those that are asked for shows that rows are to
// blame.
TEST_F(ExternalSimulators, ManyFailuresAreUnlikelyWhereFewMayFail) {
  EXPECT_EQ(chance_of_failures(0, 64, 0.0), 1.0);
  EXPECT_EQ(chance_of_failures(1, 64, 0.0), 0.0);
  EXPECT_EQ(chance_of_failures(64, 64, 1.0), 1.0);
  EXPECT_NEAR(chance_of_failures(2, 3, 0.5), 0.5, 1e-12);
  EXPECT_GT(chance_of_failures(18, 64, 0.05), kHopelessChance);
  EXPECT_LT(chance_of_failures(19, 64, 0.05), kHopelessChance);
}

TEST_F(ExternalSimulators, RowsAtBothEndsMayFail) {
  ExternalSimulator simulator =
      program("BAD='0 1 2 3 4 5 6 7 8 9 63' WHAT=crash sh sim.sh", hopeless_rows(0.05));
  RowMatrix theta = RowMatrix::Constant(64, 2, 0.5);
  theta.col(0).setLinSpaced(0.0, 63.0);
  const sim::Trajectories x = simulator.simulate(theta, {7, "test", 1, 0, 0});
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed).size(), 11u);
  expect_others_as_ever(x);
}

TEST_F(ExternalSimulators, ACallThatWentWellWhenItWasRepeatedLostNoRow) {
  study_.external.retries = 1;
  ExternalSimulator simulator =
      program("test -e again || { touch again; exit 5; }; BAD=2 WHAT=nan sh sim.sh {theta} {x}");
  RowMatrix theta = RowMatrix::Zero(4, 2);
  simulator.simulate(theta, {1, "test", 0, 0, 0});
  EXPECT_EQ(simulator.last_loss() + simulator.lost_number(), "");
  EXPECT_TRUE(simulator.last_failure().starts_with("exit status 5")) << simulator.last_failure();
  theta(3, 0) = 2.0;
  simulator.simulate(theta, {1, "test", 0, 0, 0});
  EXPECT_EQ(simulator.lost_number(), "row 3 has nan in 'y'");
  theta(3, 0) = 0.0;
  std::filesystem::remove(folder_ / "again");
  simulator.simulate(theta, {1, "test", 0, 0, 0});
  EXPECT_EQ(simulator.last_loss(), "") << "repeated again";
}

// The licence goes after some rows. Rows that fail are theirs as long as one that went well before
// still does.
TEST_F(ExternalSimulators, AProgramThatFailsFromSomeTimeOnIsAnError) {
  ExternalSimulator simulator = program("test -e gone && exit 5; BAD='' WHAT=none sh sim.sh");
  RowMatrix theta = RowMatrix::Zero(100, 2);
  simulator.simulate(theta, {1, "test", 0, 0, 0});
  folder_.file("gone", "");
  EXPECT_TRUE(has(error_of(simulator, 100, 100),
                  "failed for the last 32 rows, and then for one that it had simulated "
                  "before: exit status 5"));
}

TEST_F(ExternalSimulators, ManyRowsInARowMayFail) {
  std::string bad;
  for (int a = 10; a < 90; ++a) bad += std::to_string(a) + " ";
  const sim::Trajectories x = run(100, bad, "crash");
  EXPECT_EQ(failed_rows(x, RolloutStatus::crashed).size(), 80u);
}

TEST_F(ExternalSimulators, TheLogHoldsWhatWasPrinted) {
  {
    ExternalSimulator simulator = program("echo hello; sh sim.sh {theta} {x}");
    simulator.simulate(RowMatrix::Zero(3, 2), {1, "test", 0, 0, 0});
  }
  const std::string log = text_of(folder_ / "log");
  EXPECT_TRUE(log.starts_with("call 1, 3 rows from row 0: exit status 0 after")) << log;
  EXPECT_TRUE(has(log, "\nhello\n"));
}

TEST_F(ExternalSimulators, ColumnsMustBeNamedWhereOnlyTheObservationNamesThem) {
  study_.external.names_from = NamesFrom::observation;
  ExternalSimulator nameless = program("WHAT=none BAD= sh sim.sh");
  const std::string message = message_of<Error>([&] {
    nameless.simulate(RowMatrix::Constant(40, 2, 1.0), {1, "test", 0, 0, 0});
  });
  EXPECT_TRUE(has(message, {"no names", "y, seed", "simulator.features"}));
}

TEST_F(ExternalSimulators, TheFirstFailureIsTheOneThatIsTold) {
  ExternalSimulator simulator = program("echo 1,2 > {x}; : {theta}");
  const sim::Trajectories x =
      simulator.simulate(RowMatrix::Constant(4, 2, 1.0), {1, "test", 0, 0, 0});
  EXPECT_EQ(x.status, std::vector<RolloutStatus>(4, RolloutStatus::ok)) << "each row alone";
  EXPECT_TRUE(has(simulator.last_failure(), "has 1 row, must have 4"));
}

TEST_F(ExternalSimulators, Hdf5IsReadAndWritten) {
  {
    h5::File file = h5::File::create(folder_ / "made.h5");
    const RowMatrix x = (RowMatrix(2, 2) << 1, 2, 3, 4).finished();
    h5::Dataset dataset = file.write("x", x);
    dataset.set_attribute("labels", std::vector<std::string>{"seed", "y"});  // in another order
    file.close();
  }
  study_.external.format = FileFormat::hdf5;
  ExternalSimulator simulator = program("cp {theta} theta.h5; cp made.h5 {x}");
  const RowMatrix theta = (RowMatrix(2, 2) << 0.1, 0.5, 0.2, 0.5).finished();
  const sim::Trajectories x = simulator.simulate(theta, {1, "test", 0, 0, 0});
  EXPECT_EQ(x.values, (std::vector<float>{2, 1, 4, 3}));
  const h5::File given = h5::File::open(folder_ / "theta.h5");
  EXPECT_EQ(given.read_matrix<double>("theta"), theta);
  EXPECT_EQ(given.dataset("theta").attribute<std::vector<std::string>>("labels"),
            (std::vector<std::string>{"a", "k"}));
}

}  // namespace
}  // namespace npdr::pipeline
