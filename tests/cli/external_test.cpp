/// Commands as simulators.
#include <fmt/format.h>

#include "tests/analysis/markup_check.h"
#include "tests/cli/external_examples.h"

namespace npdr::pipeline {
namespace {

TEST_F(External, AShellScriptIsASimulator) {
  run_well({"shell.toml"});
  expect_exact_posterior("external-shell");
  EXPECT_EQ(artefact("external-shell", "simulate").dataset("x").shape(), (h5::Shape{1000, 2}));
  EXPECT_TRUE(has(table("external-shell", "fit"), "Distance to x_o [prior std]"));
  const std::string features = table("external-shell", "features");
  EXPECT_TRUE(has(features, "| total, NPE (Gaussian)"));
  const std::string html = text_of(folder_ / "runs/external-shell/report.html");
  EXPECT_FALSE(has(html, "trajectories"));
  EXPECT_FALSE(has(html, "Warning"));
  EXPECT_TRUE(has(html, "Posterior samples"));
}

// That of docs/external-simulators.md.
std::string documented_function() {
  const std::string page = text_of(NPDR_SOURCE_DIR "/docs/external-simulators.md");
  const std::size_t begin = page.find("import npdr_command\n");
  return page.substr(begin, page.find("```", begin) - begin);
}

TEST_F(External, APythonFunctionIsASimulator) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  folder_.file("sim.py", documented_function());
  const std::string command = "simulator.command='" + python + " sim.py {theta} {x}'";
  run_well({"shell.toml", "--set", command});
  expect_exact_posterior("external-shell");
  const auto problem_of = [&](const std::string& function) {
    folder_.file("sim.py", "import npdr_command\nnpdr_command.run(" + function + ")\n");
    const Outcome outcome = npdr(3, {"validate", "shell.toml", "--try", "3", "--set", command});
    return outcome.err;
  };
  for (const auto& [function, problem] : std::vector<std::pair<std::string, std::string>>{
           {"lambda theta, rng: theta[\"c\"]", "the study has no parameter 'c'; it has a, b"},
           {"lambda theta, rng: [1.0, 2.0][:1 + (theta[\"a\"] > 0)]",
            "returned 1 numbers and 2 numbers, must be the same of all rows"},
           {"lambda theta, rng: {\"total\": 1.0, str(theta[\"a\"]): 2.0}",
            "must be the same of all rows"},
           {"lambda theta, rng: [1j, 2.0]", "must be real ones"},
           {"lambda theta, rng: None", "simulate() returned None, must be numbers"},
           {"lambda theta, rng: {\"total\": [1.0, 2.0]}", "returned 2 numbers with 1 names"}}) {
    EXPECT_TRUE(has(problem_of(function), problem));
  }
  folder_.file("sim.py",
               "import npdr_command\n"
               "def simulate(theta, rng):\n"
               "    if theta['a'] > 0:\n"
               "        raise ValueError('a is\\npositive')\n"
               "    return {'total': 1.0, 'difference': 2.0}\n"
               "npdr_command.run(simulate)\n");
  const Outcome outcome = npdr(0, {"validate", "shell.toml", "--try", "9", "--set", command});
  EXPECT_TRUE(has(outcome.out, {"  crashed\n", "  x: total = 1, difference = 2\n"}));
  EXPECT_TRUE(has(outcome.err, " of 9 rows failed: ValueError: a is positive\n"));
}

TEST_F(External, AnObservationThatMayHaveBeenCutIsWarnedOf) {
  const auto warnings = [&] { return npdr({"validate", "shell.toml"}).err; };
  const std::string whole = text_of(folder_ / "x_o.csv");
  EXPECT_FALSE(has(warnings(), "x_o.csv"));
  folder_.file("x_o.csv", whole.substr(0, whole.size() - 1));
  EXPECT_TRUE(says(warnings(),
                   {"npdr validate: shell.toml:8:15: warning: x_o.csv: its last line has no end"}));
}

TEST_F(External, RowsThatAreProbablyWrongAreToldAtOnceAndInTheReport) {
  folder_.file("exact.sh", "sed 's/a,b/total,difference/' \"$1\" > \"$2\"\n");
  const Outcome outcome =
      npdr(0, {"run", "shell.toml", "--set", "simulator.command='sh exact.sh {theta} {x}'"});
  const std::string warning = "rows of the same parameters are the same, whatever their seeds";
  EXPECT_TRUE(has(outcome.err, "warning: " + warning));
  EXPECT_TRUE(has(text_of(folder_ / "runs/external-shell/report.html"), "Warning: " + warning));
}

// 25 features; the seventh is 1 whatever the parameters, and 2 in the observation.
TEST_F(External, OfManyFeaturesTheGreatestSurprisesAreDrawnAndTheTableIsFolded) {
  folder_.file("more.awk",
               "BEGIN { FS = OFS = \",\" }\n"
               "{ for (i = 3; i <= 25; ++i) $i = NR == 1 ? \"f\" i : i * $1 + (i - 10) * $2 }\n"
               "NR > 1 { $7 = seventh } { print }\n");
  folder_.file(
      "many.sh",
      "sh linear_gaussian.sh \"$1\" two.csv && awk -v seventh=1 -f more.awk two.csv > \"$2\"");
  const std::string folder = folder_.path().string();
  ASSERT_EQ(std::system(("cd " + folder +
                         " && awk -v seventh=2 -f more.awk x_o.csv > x.csv && "
                         "mv x.csv x_o.csv")
                            .c_str()),
            0);
  run_well({"shell.toml", "--set", "simulator.command='sh many.sh {theta} {x}'", "--set",
            "method.num_simulations=200"});
  const auto study = folder_ / "runs/external-shell";
  const std::string figure = text_of(study / "figures/features.svg");
  const std::string tip = "<title>f7\nNPE (Gaussian): they hardly vary, or failed</title>";
  EXPECT_EQ(figure.find("<title>f"), figure.find(tip));
  EXPECT_EQ(analysis::count_of(figure, "class=\"tip\""), 20);
  const std::string html = text_of(study / "report.html");
  EXPECT_TRUE(has(html, {"id=\"table-features\">\n<details>", "the 20 that surprise most of 25"}));

  const auto warning = [&](const std::string& awk) {
    const std::string make = "awk -F, -v OFS=, -v seventh=1 -f more.awk x_o.csv | ";
    EXPECT_EQ(std::system(("cd " + folder + " && " + make + awk + " > other.csv").c_str()), 0);
    return npdr({"sample", (study / "npe-gaussian/seed-1/round-1/infer.h5").string(), "-n", "1",
                 "--x", "other.csv"})
        .err;
  };
  EXPECT_EQ(warning("cat"), "") << "one that fits";
  EXPECT_TRUE(says(warning("head -c -1"), {"warning: other.csv: its last line has no end"}));
  EXPECT_TRUE(says(warning("awk -F, -v OFS=, 'NR > 1 { $7 = 2 } { print }'"),
                   {"warning: other.csv is unlike all simulations that the posterior was learned "
                    "from",
                    "'f7' is 2, in all simulations 1"}));
  EXPECT_TRUE(says(
      warning("awk -F, -v OFS=, 'NR > 1 { $25 += 20 } { print }'"),
      {"warning: other.csv is unlike all simulations", "its features together, no single one"}));
}

TEST_F(External, OfASimulatorThatCrashesOnlyTheCulpritsAreLost) {
  run_well({"shell.toml", "--until", "simulate"});
  // Fewer samples, as each call of theirs has culprits, too; they add 0.01 to the mean's error.
  run_well({"crashing.toml", "--set", "evaluate.num_samples=300"});
  // One in twenty: 50 of 1000, with a deviation of 7.
  EXPECT_NEAR(static_cast<double>(num_rows_lost("external-crashing", 4)), 50.0, 30.0);
  expect_exact_posterior("external-crashing");
  EXPECT_TRUE(
      has(table("external-crashing", "fit"), "simulations failed and were left out of training"));
  EXPECT_TRUE(has(npdr(3, {"run", "crashing.toml", "--set", "evaluate.num_samples=300", "--set",
                           "limits.max_failed_fraction=0.001"})
                      .err,
                  " crashed), limits.max_failed_fraction = 0.001 allows 1; see the logs"));
}

TEST_F(External, ResultsDoNotDependOnTheShards) {
  run_well({"shell.toml", "--until", "evaluate", "--work", "whole"});
  run_well(
      {"shell.toml", "--until", "evaluate", "--work", "parts", "--set", "simulate.shard_size=130"});
  EXPECT_EQ(digests(folder_ / "parts/external-shell"), digests(folder_ / "whole/external-shell"));
}

TEST_F(External, FeaturesGetTrainedLayersByTheirShape) {
  run_well({"shell.toml", "--until", "evaluate", "--set", "method.embedding.shape=[1, 2, 1]"});
  expect_exact_posterior("external-shell");
  const Outcome wrong = npdr(2, {"run", "shell.toml", "--set", "method.embedding.shape=[1, 5, 1]"});
  EXPECT_TRUE(has(wrong.err, "= [1, 5, 1], must be of a product of 2, the number of features"));
}

TEST_F(External, SamplesOfParametersWithCommasInTheirUnitsComeBack) {
  run_well({"shell.toml", "--until", "infer", "--set", "method.num_simulations=200", "--set",
            "simulator.parameter=[{name='a', unit='N,m'}, {name='b', unit='1'}]"});
  const std::string posterior = "runs/external-shell/npe-gaussian/seed-1/round-1/infer.h5";
  folder_.file("theta.csv", npdr({"sample", posterior, "-n", "3"}).out);
  npdr(0, {"log-prob", posterior, "theta.csv"});
}

TEST_F(External, ATruthIsObservedByTheCommandAndRoundsFollow) {
  run_well({"shell.toml", "--set", "target.truth={ a = 0.5, b = -0.5 }", "--set",
            "simulator.features=[\"total\", \"difference\"]", "--set", "method.num_rounds=2",
            "--set", "method.num_simulations=300"});
  EXPECT_TRUE(has(table("external-shell", "seeds"), "log p(truth)"));
  EXPECT_TRUE(has(table("external-shell", "fit"), "truth"));
}

// The rows that a run begins with.
TEST_F(External, SomeRowsCanBeTried) {
  const Outcome good = npdr(0, {"validate", "shell.toml", "--try", "2"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "runs")) << "nothing is written";
  run_well({"shell.toml", "--until", "simulate"});
  const h5::File simulated = artefact("external-shell", "simulate");
  const auto theta = simulated.read_matrix<double>("theta", 1000, 2, h5::Values::finite);
  const auto x = simulated.read_matrix<float>("x", 1000, 2, h5::Values::finite);
  for (Index i = 0; i < 2; ++i) {
    const std::string row =
        fmt::format("row {}: a = {:.6g}, b = {:.6g}\n  x: total = {:.6g}, difference = {:.6g}\n", i,
                    theta(i, 0), theta(i, 1), x(i, 0), x(i, 1));
    EXPECT_TRUE(has(good.out, row));
  }
}

TEST_F(External, ATrialSaysWhyRowsFailed) {
  const auto tried = [&](const std::string& number, const std::string& command) {
    return npdr({"validate", "shell.toml", "--try", number, "--set",
                 "simulator.command='" + command + "'"});
  };
  const Outcome bad = tried("10", "echo no licence >&2; exit 5 # {theta} {x}");
  EXPECT_EQ(bad.status, 3);
  EXPECT_TRUE(has(bad.out, "\n  crashed\n"));
  EXPECT_TRUE(has(
      bad.err, {"npdr validate: no row that was tried has a result: exit status 5", "no licence"}));
  const Outcome some = tried(
      "2", "{ echo total,difference; echo 1,nan; test $(wc -l <{theta}) = 2 || echo 1,2; } >{x}");
  EXPECT_EQ(some.status, 0) << some.err;
  EXPECT_TRUE(has(some.err, "warning: 1 of 2 rows failed: row 0 has nan in 'difference'"));
}

TEST_F(External, OtherCommandsUnderstandSuchStudies) {
  run_well({"shell.toml", "--until", "infer"});
  const std::string round = "runs/external-shell/npe-gaussian/seed-1/round-1/";
  EXPECT_TRUE(has(npdr({"verify", round + "simulate.h5", "--rows", "3", "--run-command"}).out,
                  "3 of 1000 rows "
                  "recomputed, 0 differ"));
  EXPECT_TRUE(has(npdr({"validate", "shell.toml", "--set", "diagnose.checks=[\"training\"]"}).out,
                  "samples of each posterior\n"))
      << "that check asks for no predictions";
  EXPECT_TRUE(has(npdr({"explain", "shell.toml", "--set", "simulator.retries=3", "simulate"}).out,
                  "simulator.retries: 3, was 1"));
  const std::string longer =
      npdr({"explain", "shell.toml", "--set",
            "simulator.command=\"sh linear_gaussian.sh {theta} {x} " + std::string(99, 'a') + "\"",
            "simulate"})
          .out;
  EXPECT_TRUE(has(longer, "aaa..., was ..."));
  EXPECT_FALSE(has(longer, std::string(61, 'a')));
  std::ofstream(folder_ / "linear_gaussian.sh", std::ios::app) << "# edited\n";
  EXPECT_TRUE(
      has(npdr({"explain", "shell.toml", "simulate"}).out, "simulator.files.linear_gaussian.sh: "));
  std::ofstream(folder_ / "other.csv") << "difference,total\n0.5,1\n";
  const std::string posterior = round + "infer.h5";
  const Outcome own = npdr({"sample", posterior, "-n", "3"});
  const Outcome other = npdr({"sample", posterior, "-n", "3", "--x", "other.csv"});
  EXPECT_EQ(other.out, own.out) << "the same x_o with its columns in another order\n" << other.err;
  EXPECT_FALSE(has(other.err, "warning"));
  folder_.file("far.csv", "difference,total\n0.5,1000\n");
  EXPECT_TRUE(
      says(npdr({"sample", posterior, "-n", "3", "--x", "far.csv"}).err,
           {"warning: far.csv is unlike all simulations that the posterior was learned from",
            "the farthest feature is 'total'", "check the units"}));
  std::ofstream(folder_ / "theta.csv") << own.out;
  npdr(0, {"log-prob", posterior, "theta.csv"});
  std::ofstream(folder_ / "wide.csv") << "1,2,3\n";
  const Outcome wide = npdr(2, {"sample", posterior, "--x", "wide.csv"});
  EXPECT_TRUE(
      says(wide.err, {"npdr sample: wide.csv: has 3 columns", "must have 2", "total, difference"}));
}

// Of the second observation a would be 2.
TEST_F(External, SamplesOfAnotherObservationThatPressOnABoundAreTold) {
  run_well({"shell.toml", "--until", "infer", "--set", "prior.a={uniform=[-1.0, 1.0]}"});
  const std::string posterior = "runs/external-shell/npe-gaussian/seed-1/round-1/infer.h5";
  const auto warnings = [&](const std::string& x) {
    std::ofstream(folder_ / "x.csv") << "difference,total\n" << x << "\n";
    return npdr({"sample", posterior, "--x", "x.csv"}).err;
  };
  EXPECT_FALSE(has(warnings("0.1,0.2"), "press"));
  EXPECT_TRUE(has(warnings("1.9,2.1"),
                  "warning: the samples press against the end of the prior (a at 1), which may "
                  "exclude the truth: widen it in a study of this observation"));
}

// Rows of a program that isn't the one of their key.
TEST_F(External, OfAProgramThatIsEditedWhileItRunsNoRowsAreKept) {
  EXPECT_TRUE(has(
      npdr(1, {"run", "shell.toml", "--set",
               "simulator.command='echo \"#\" >> linear_gaussian.sh; sh linear_gaussian.sh {theta} "
               "{x}'"})
          .err,
      "linear_gaussian.sh was edited since this began"));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "runs")) {
    EXPECT_FALSE(entry.path().string().find("simulate") != std::string::npos &&
                 entry.path().extension() == ".h5")
        << entry.path();
  }
}

TEST_F(External, ARequestToStopEndsTheCommandAndTheNextRunGoesOn) {
  const auto pid_file = folder_ / "pid";
  const std::string wait_once =
      "test -e go || { echo $$ > pid; tail -f /dev/null; }; sh linear_gaussian.sh";
  const std::vector<std::string> words = {"npdr",
                                          "run",
                                          "shell.toml",
                                          "--until",
                                          "simulate",
                                          "--set",
                                          "simulator.command=" + wait_once};
  const Program program(folder_.path(), words);
  ASSERT_TRUE(comes_true([&] { return text_of(pid_file).ends_with('\n'); }));
  const pid_t command = std::stoi(text_of(pid_file));
  program.send(SIGTERM);
  EXPECT_EQ(program.wait().status, 75);
  EXPECT_TRUE(comes_true([&] { return has_ended(command); }));
  std::ofstream(folder_ / "go");
  EXPECT_EQ(run(folder_.path(), words).status, 0);
}

}  // namespace
}  // namespace npdr::pipeline
