#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "core/atomic_file.h"
#include "tests/cli/study_run.h"

namespace npdr::pipeline {
namespace {

class Commands : public SmallRun {};

TEST_F(Commands, RunPrintsTheTablesAndTheReportsPath) {
  EXPECT_TRUE(has(run_output_, {"| RMSE ", "| pole_mass ", "report: runs/small/report.html"}));
  EXPECT_TRUE(has(text_of(file("runs/small/tables/intervals.md")), "| pole_mass   | kg   | [0."));
  for (const char* name :
       {"tables/fit.md", "tables/fit.csv", "tables/fit.tex", "figures/pair_plot.svg",
        "figures/pair_plot.png", "figures/trajectories.svg", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(file("runs/small") / name)) << name;
  }
}

TEST_F(Commands, StatusShowsEveryArtefactUpToDate) {
  const Outcome status = npdr({"status", "small.toml"});
  EXPECT_TRUE(has(status.out, "15 artefacts: 15 up to date"));
  const auto json = nlohmann::json::parse(npdr({"status", "small.toml", "--json"}).out);
  EXPECT_EQ(json.size(), 15u);
}

TEST_F(Commands, RunSaysWhatAnotherProcessMakes) {
  const auto rows =
      nlohmann::json::parse(npdr({"status", "small.toml", "--work", "busy", "--json"}).out);
  const auto target = std::ranges::find(
      rows, "target", [](const auto& row) { return row.at("stage").template get<std::string>(); });
  ASSERT_NE(target, rows.end());
  const AtomicFile making(file(target->at("path").get<std::string>()));
  std::ofstream(making.temporary()) << "a part";
  const auto warning = [](const char* stage) {
    return npdr({"run", "small.toml", "--work", "busy", "--until", stage}).err;
  };
  EXPECT_TRUE(says(warning("propose"),
                   {fmt::format("npdr run: warning: process {} makes target already", getpid()),
                    "does that work once more", "\nsmall: 100 %"}));
  EXPECT_FALSE(has(warning("propose"), "already, and")) << "it is made";
}

TEST_F(Commands, ExplainNamesTheKeyThatChanged) {
  const Outcome outcome = npdr(
      {"explain", "small.toml", "--set", "method.training.learning_rate=0.25", "infer NPDR (MAF)"});
  EXPECT_TRUE(has(outcome.out, "training.learning_rate: 0.25, was 0.001"));
}

TEST_F(Commands, ValidatePrintsTheResolvedStudyAndItsWork) {
  EXPECT_FALSE(has(npdr({"validate", "small.toml"}).out, "{"));
  const Outcome outcome = npdr({"validate", "small.toml", "--resolved"});
  EXPECT_TRUE(
      has(outcome.out, {"\"clip_norm\": 5.0", "(900 rollouts of 400 steps), 4 posteriors"}));
  // The folds leave out two and one of three rollouts.
  const Outcome folds = npdr({"validate", "small.toml", "--set", "target.num_rollouts=3", "--set",
                              "evaluate.leave_out=2"});
  EXPECT_TRUE(has(folds.out, "(2700 rollouts of 400 steps), 12 posteriors")) << folds.err;
}

TEST_F(Commands, ATrialReplaysWhatInferenceSees) {
  const Outcome outcome =
      npdr({"validate", "small.toml", "--try", "1", "--set", "target.held_out=1"});
  EXPECT_TRUE(has(outcome.out, "\n  2 rollouts of 400 states; the last: theta = ")) << outcome.err;
}

TEST_F(Commands, AnotherFileWithTheSameNameIsWarnedOfTheReportThatItReplaces) {
  std::ofstream(file("copy.toml")) << small_study().with("evaluate", {"num_samples = 40"});
  EXPECT_TRUE(says(npdr({"validate", "copy.toml"}).err,
                   {"npdr validate: copy.toml:2:8: warning: study.name = 'small' is that of "
                    "small.toml, too, whose report runs/small/report.html will be replaced"}));
  EXPECT_EQ(npdr({"validate", "small.toml"}).err, "");
  std::ofstream(file("same.toml")) << small_study();
  EXPECT_EQ(npdr({"validate", "same.toml"}).err, "") << "nothing would be replaced";
}

TEST_F(Commands, OpenSaysWhereResultsAre) {
  const Outcome outcome = npdr(0, {"open", "small.toml"});
  EXPECT_TRUE(
      has(outcome.out, {"report       runs/small/report.html\n", "tables       runs/small/tables\n",
                        "posterior    runs/small/npdr-maf/seed-1/round-2/infer.h5\n"}));
  EXPECT_FALSE(has(outcome.out, "round-1"));
  EXPECT_TRUE(has(npdr({"open", "small.toml", "--work", "none"}).out,
                  "isn't there yet, or is of other settings: npdr run"));
}

TEST_F(Commands, AFileCantBeTheWorkFolder) {
  for (const std::string command : {"status", "tasks", "run", "open"}) {
    EXPECT_TRUE(says(npdr(2, {command, "small.toml", "--work", "small.toml"}).err,
                     {"npdr " + command +
                      ": --work = 'small.toml', which isn't a "
                      "folder; must be the folder of results"}));
  }
}

TEST_F(Commands, ExplainNamesAFileThatWasRemoved) {
  const auto link = file("runs/small/npdr-maf/seed-1/round-2/evaluate.h5");
  const auto path = std::filesystem::canonical(link), aside = file("aside.h5");
  std::filesystem::rename(path, aside);
  const Outcome outcome = npdr({"explain", "small.toml", "evaluate NPDR (MAF)"});
  std::filesystem::rename(aside, path);
  EXPECT_TRUE(has(outcome.out, {"its file was removed: ", path.filename().string()}));
}

// A temporary of a process that lives is work that goes on: here that of this test.
TEST_F(Commands, StatusShowsWhatAnotherProcessMakes) {
  const auto path =
      std::filesystem::canonical(file("runs/small/npdr-maf/seed-1/round-2/evaluate.h5"));
  std::filesystem::rename(path, file("aside.h5"));
  std::string status;
  {
    const AtomicFile in_the_making(path);
    status = npdr({"status", "small.toml"}).out;
  }
  std::filesystem::rename(file("aside.h5"), path);
  EXPECT_TRUE(has(status, {"1 running, 14 up to date", "process " + std::to_string(getpid())}));
}

TEST_F(Commands, UnknownOnesAreNamed) {
  const Outcome outcome = npdr(2, {"runn", "small.toml"});
  EXPECT_TRUE(
      outcome.err.starts_with("npdr: unknown command 'runn' (did you mean 'run'?); known: "))
      << outcome.err;
}

TEST_F(Commands, AChangedTrainingKeyKeepsTheSimulationsOfRoundOne) {
  EXPECT_EQ(npdr({"run", "small.toml", "--dry-run"}).out, "");
  const Outcome plan =
      npdr({"run", "small.toml", "--dry-run", "--set", "method.training.learning_rate=2e-3"});
  EXPECT_FALSE(has(plan.out, "# simulate NPDR (MAF), seed 1, round 1"));
  EXPECT_TRUE(has(
      plan.out, {"# infer NPDR (MAF), seed 1, round 1", "# simulate NPDR (MAF), seed 1, round 2"}));
}

TEST_F(Commands, SeedsMayBeRangesAndComeBeforeWhatTheyBelongTo) {
  const std::string status = npdr({"status", "small.toml"}).out;
  for (const std::vector<std::string>& seeds :
       {std::vector<std::string>{"1"}, {"1-1"}, {"1,1", "--seeds", "1"}}) {
    EXPECT_EQ(npdr(joined(joined({"status", "--seeds"}, seeds), {"small.toml"})).out, status);
  }
  npdr(0, {"explain", "--seeds", "1", "small.toml", "target"});
  EXPECT_TRUE(has(npdr(2, {"status", "--seeds", "1-x", "small.toml"}).err,
                  "'1-x' is no list of numbers and ranges"));
}

TEST_F(Commands, DeletedTablesAreMadeAgain) {
  std::filesystem::remove_all(file("runs/small/tables"));
  EXPECT_EQ(npdr({"run", "small.toml"}).out, run_output_);
  EXPECT_TRUE(std::filesystem::exists(file("runs/small/tables/fit.csv")));
}

// The caption stands below other tables.
TEST_F(Commands, AReportWithoutTheRoundsRemovesTheirTables) {
  const auto run_with = [](const std::string& rounds) {
    npdr(0, {"run", "small.toml", "--set", "study.name=rounds", "--set",
             "evaluate.rounds=" + rounds, "--set", "report.caption=What one sees."});
  };
  run_with("all");
  EXPECT_TRUE(has(text_of(file("runs/rounds/tables/densities.md")),
                  {" prior |", "| round 2 |", "| NPDR (MAF), truth ", "| NPDR (MoG), truth "}));
  EXPECT_TRUE(std::filesystem::exists(file("runs/rounds/tables/rounds.md")));
  run_with("last");
  const std::string html = text_of(file("runs/rounds/report.html"));
  const std::size_t caption = html.find("<p>What one sees.</p>");
  EXPECT_LT(html.find("id=\"table-fit\""), caption);
  EXPECT_LT(caption, html.find("id=\"section-3\""));
  EXPECT_FALSE(std::filesystem::exists(file("runs/rounds/tables/rounds.md")));
  EXPECT_FALSE(std::filesystem::exists(file("runs/rounds/tables/densities.md")));
}

TEST_F(Commands, InspectShowsInputsContentAndTheAttributesOfAnArtefactsOwn) {
  const Outcome posterior = npdr({"inspect", "runs/small/npdr-maf/seed-1/round-1/infer.h5"});
  EXPECT_TRUE(
      has(posterior.out, {"    @embedding = {\"kind\":\"linear\",", "    @num_failed = 0\n",
                          "    @num_simulations = 150\n",
                          R"(    @prior = [{"name":"pole_mass","unit":"kg","uniform":[0.3,1.7]},)"
                          R"({"name":"pole_length","unit":"m","uniform":[0.3,1.7]}])"}));
  EXPECT_FALSE(has(posterior.out, "@key_document"));
  EXPECT_TRUE(
      has(npdr({"inspect", "--digest", "runs/small/npdr-maf/seed-1/round-1/simulate.h5"}).out,
          {"simulation (schema", "proposal", "trajectories (150, 2, 400, 2)", "content  ",
           "    @num_failed = 0\n", "@DIMENSION_LABELS = row, rollout, time, channel"}));
}

TEST_F(Commands, ShardsKnowTheVersionOfTheirSchema) {
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(file("runs/.cache/simulate"))) {
    if (!entry.path().filename().string().starts_with("rows-")) continue;
    const ArtefactInfo info = read_artefact_info(entry.path());
    EXPECT_EQ(info.identity.key_document.at("schema_version"), info.schema.version);
  }
}

TEST_F(Commands, StagesRunOneByOneGiveTheSameBitsAsARun) {
  const auto stage = [&](const std::string& name, const std::vector<std::string>& more) {
    with_status(0, run(folder_->path(), joined({name, "small.toml", "--work", "staged"}, more)));
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

}  // namespace
}  // namespace npdr::pipeline
