#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Commands : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    std::ofstream(folder_->path() / "small.toml") << small_study();
    const Outcome outcome = npdr({"run", "small.toml"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    run_output_ = outcome.out;
  }
  static void TearDownTestSuite() { delete folder_; }

  static Outcome npdr(std::vector<std::string> words) {
    words.insert(words.begin(), "npdr");
    return run(folder_->path(), words);
  }
  static std::filesystem::path file(const std::string& name) { return folder_->path() / name; }

  static TempFolder* folder_;
  static std::string run_output_;
};
TempFolder* Commands::folder_ = nullptr;
std::string Commands::run_output_;

TEST_F(Commands, RunPrintsTheTableAndTheReportsPath) {
  EXPECT_NE(run_output_.find("| RMSE "), std::string::npos) << run_output_;
  EXPECT_NE(run_output_.find("report: runs/small/report.html"), std::string::npos);
  for (const char* name :
       {"tables/fit.md", "tables/fit.csv", "tables/fit.tex", "figures/pair_plot.svg",
        "figures/pair_plot.png", "figures/trajectories.svg", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(file("runs/small") / name)) << name;
  }
}

TEST_F(Commands, StatusShowsEveryArtefactUpToDate) {
  const Outcome status = npdr({"status", "small.toml"});
  EXPECT_NE(status.out.find("15 artefacts: 15 up to date"), std::string::npos) << status.out;
  const auto json = nlohmann::json::parse(npdr({"status", "small.toml", "--json"}).out);
  EXPECT_EQ(json.size(), 15u);
}

TEST_F(Commands, ExplainNamesTheKeyThatChanged) {
  const Outcome outcome = npdr(
      {"explain", "small.toml", "--set", "method.training.learning_rate=0.25", "infer NPDR (MAF)"});
  EXPECT_NE(outcome.out.find("training.learning_rate: 0.25, was 0.0005"), std::string::npos)
      << outcome.out;
}

TEST_F(Commands, ValidatePrintsTheResolvedStudyAndItsWork) {
  const Outcome outcome = npdr({"validate", "small.toml"});
  EXPECT_NE(outcome.out.find("\"clip_norm\": 5.0"), std::string::npos);
  EXPECT_NE(outcome.out.find("(900 rollouts of 400 steps), 4 posteriors"), std::string::npos)
      << outcome.out;
}

TEST_F(Commands, SampleAndLogProbUseAPosterior) {
  const std::string posterior = "runs/small/npdr-maf/seed-1/round-2/infer.h5";
  const Outcome samples = npdr({"sample", posterior, "-n", "20"});
  ASSERT_EQ(samples.status, 0) << samples.err;
  EXPECT_EQ(samples.out.substr(0, samples.out.find('\n')), "pole_mass [kg],pole_length [m]");
  EXPECT_EQ(std::count(samples.out.begin(), samples.out.end(), '\n'), 21);
  std::ofstream(file("theta.csv")) << samples.out;
  const Outcome densities = npdr({"log-prob", posterior, "theta.csv"});
  ASSERT_EQ(densities.status, 0) << densities.err;
  EXPECT_EQ(std::count(densities.out.begin(), densities.out.end(), '\n'), 21);
  EXPECT_EQ(densities.out.find("inf"), std::string::npos);
}

TEST_F(Commands, InspectShowsKindInputsAndContent) {
  const Outcome outcome =
      npdr({"inspect", "--digest", "runs/small/npdr-maf/seed-1/round-1/simulate.h5"});
  for (const char* part :
       {"simulation (schema", "proposal", "trajectories (150, 2, 400, 2)", "content  "}) {
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;
  }
}

TEST_F(Commands, StagesRunOneByOneGiveTheSameBitsAsARun) {
  const std::vector<std::string> study = {"small.toml", "--work", "staged"};
  const auto stage = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words = {name};
    words.insert(words.end(), study.begin(), study.end());
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(folder_->path(), words);
    EXPECT_EQ(outcome.status, 0) << name << ": " << outcome.err;
  };
  for (const char* round : {"1", "2"}) {
    stage("npdr-propose", {"--round", round});
    stage("npdr-simulate", {"--round", round, "--shard", "0"});
    stage("npdr-infer", {"--round", round});
  }
  stage("npdr-evaluate", {});
  stage("npdr-report", {});
  EXPECT_EQ(digests(file("staged/small")), digests(file("runs/small")));
}

TEST_F(Commands, NewWritesAStudyThatIsValid) {
  EXPECT_EQ(npdr({"new", "mine"}).status, 0);
  EXPECT_EQ(npdr({"validate", "mine.toml", "--quiet"}).status, 0);
  EXPECT_EQ(npdr({"new", "mine"}).status, 2);
}

TEST_F(Commands, HelpAndListsAreThere) {
  for (const char* command : {"run", "status", "explain", "validate", "new", "list", "import",
                              "inspect", "verify", "sample", "log-prob"}) {
    EXPECT_EQ(npdr({command, "--help"}).status, 0) << command;
  }
  for (const char* what : {"simulators", "methods", "embeddings", "estimators", "keys"}) {
    EXPECT_FALSE(npdr({"list", what}).out.empty()) << what;
  }
}

}  // namespace
}  // namespace npdr::pipeline
