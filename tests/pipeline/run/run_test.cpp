// What a run knows and says of its jobs.

#include <fstream>

#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/run/artefact_status.h"
#include "pipeline/run/run_progress.h"
#include "tests/pipeline/small_study.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(RunCosts, ComeFromTheNearestKin) {
  const Plan plan = make_plan(parse_study(kStudyText, "s.toml", {}), WorkFolder("none"));
  RunCosts costs(plan);
  const Node& maf = plan.node(Stage::infer, {"NPDR (MAF)", 1, 1});
  const Node& other_seed = plan.node(Stage::infer, {"NPDR (MAF)", 2, 1});
  const Node& mog = plan.node(Stage::infer, {"NPDR (MoG)", 1, 1});
  const Node& few = plan.node(Stage::simulate, {"NPDR (MAF)", 1, 1});   // 200 rows
  const Node& many = plan.node(Stage::simulate, {"NPDR (MoG)", 1, 1});  // 1000 rows
  EXPECT_FALSE(costs.expected(maf));
  costs.learn(few, 10.0);
  EXPECT_DOUBLE_EQ(*costs.expected(many), 10.0 * static_cast<double>(num_rows(plan, many)) / 200.0)
      << "by the row";
  EXPECT_FALSE(costs.expected(maf)) << "simulations say nothing of training";
  costs.learn(maf, 30.0);
  EXPECT_DOUBLE_EQ(*costs.expected(other_seed), 30.0);
  EXPECT_DOUBLE_EQ(*costs.expected(mog), 30.0) << "as the stage";
  costs.learn(mog, 2.0);
  EXPECT_DOUBLE_EQ(*costs.expected(other_seed), 30.0);
}

// Ten rounds: proposals and simulations have shown what they cost, trainings haven't.
TEST(WorkLeft, TellsAShareOnceEachStageHasShownItsCost) {
  WorkLeft rest;
  EXPECT_EQ(rest.share_done(5.0, 1), 1.0) << "nothing is left";
  for (int i = 0; i < 9; ++i) {
    rest.add(Stage::propose, 0.5);
    rest.add(Stage::simulate, 1.5);
  }
  rest.add(Stage::report, {});
  EXPECT_DOUBLE_EQ(*rest.share_done(19.0, 19), 0.5) << "the report: as much as any";
  rest.add(Stage::infer, 100.0);
  EXPECT_LT(*rest.share_done(19.0, 19), 0.15);
  rest.add(Stage::evaluate, {});
  EXPECT_TRUE(rest.share_done(19.0, 19));
  rest.add(Stage::evaluate, {});
  EXPECT_FALSE(rest.share_done(19.0, 19)) << "two of a stage";
}

TEST(WorkLeft, TakesAReportAloneForOneOfMany) {
  WorkLeft rest;
  rest.add(Stage::report, {});
  EXPECT_DOUBLE_EQ(*rest.share_done(19.0, 19), 0.95);
  EXPECT_FALSE(rest.share_done(1.0, 0)) << "it is all there is";
  rest.add(Stage::evaluate, {});
  EXPECT_FALSE(rest.share_done(19.0, 19)) << "another stage may cost more than all before";
}

const RunProgress kRun = {
    "pendulum", 163, 263, 60.0, 0.75, 20.0, {"infer A: 12 epochs", "evaluate B"}};

TEST(RunDisplay, HasABarAndALineForEachJobForWhichThereIsRoom) {
  EXPECT_EQ(live_lines(kRun, {80, 24}),
            (std::vector<std::string>{
                "pendulum [################......]  75 % 01:00, 00:20 left, 163 of 263 artefacts",
                "  infer A: 12 epochs", "  evaluate B"}));
  EXPECT_EQ(live_lines(kRun, {80, 4}).back(), "  2 jobs: infer A: 12 epochs");
  EXPECT_EQ(live_lines(kRun, {80, 2}).size(), 1u);
  RunProgress run = kRun;  // before anything is known of the rest
  run.share = run.seconds_left = std::nullopt;
  EXPECT_EQ(log_line(run),
            "pendulum: 163 of 263 artefacts [01:00] | infer A: 12 epochs | evaluate B");
  EXPECT_EQ(live_lines(run, {80, 24}).front(),
            "pendulum [......................] 01:00, 163 of 263 artefacts");
}

TEST(FailureWords, TellACauseOnce) {
  FailureWords words;
  EXPECT_EQ(words.tell("infer", 75, {"stopped on request"}, {"logs/0.log"}),
            "npdr: infer stopped (exit status 75):\n    stopped on request\n    log: logs/0.log\n");
  EXPECT_EQ(words.tell("simulate", 1, {"sim failed for each of 32 rows: KeyError", "  in a.log"},
                       {"logs/1.log"}),
            "npdr: simulate failed (exit status 1):\n"
            "    sim failed for each of 32 rows: KeyError\n      in a.log\n    log: logs/1.log\n");
  EXPECT_EQ(words.tell("baseline", 1, {"sim failed for each of 65 rows: KeyError", "  in b.log"},
                       {"logs/2.log"}),
            "npdr: baseline failed (exit status 1), as above:\n      in b.log\n"
            "    log: logs/2.log\n");
  EXPECT_EQ(words.tell("infer", 2, {"posterior.h5: is damaged"}, {"logs/3.log"}),
            "npdr: infer failed (exit status 2):\n    posterior.h5: is damaged\n"
            "    log: logs/3.log\n");
  EXPECT_EQ(words.tell("infer", 2, {"posterior_2.h5: is damaged", "  in a.log"}, {"logs/4.log"}),
            "npdr: infer failed (exit status 2):\n    posterior_2.h5: is damaged\n"
            "    log: logs/4.log\n");
}

TEST(FailureWords, AreTheEndOfTheLogWhereAJobSaysNothing) {
  const TempFolder folder;
  std::string lines;
  for (int i = 1; i <= 21; ++i) lines += std::to_string(i) + "\n";
  const auto log = folder.file("log", lines);
  const std::string told = FailureWords().tell("infer", 137, {}, {log});
  EXPECT_TRUE(
      told.starts_with("npdr: infer failed (killed by signal 9, often for want of memory; "
                       "run it again, with a smaller --jobs if that recurs):\n    2\n    3\n"))
      << told;
  EXPECT_TRUE(told.ends_with("    21\n    log: " + log.string() + "\n")) << told;
  EXPECT_EQ(FailureWords().tell("infer", 139, {}, {log, std::filesystem::file_size(log)}),
            "npdr: infer failed (killed by signal 11, it crashed, maybe in a simulator.library; a "
            "worker that crashes costs only rows):\n    log: " +
                log.string() + "\n")
      << "what an earlier job left there is none of its words";
}

TEST(ArtefactStatus, SaysHowFarARefinementHasCome) {
  const TempFolder folder;
  const std::string study =
      pendulum_study("refined")
          .with("observation_noise", {"scale = 0.1"})
          .method("Start", {"embedding = { kind = \"bayessim\" }", kSmallMixture})
          .method("Refined", {"algorithm = \"refine\"", "refine = { start = \"Start\" }"});
  const Plan plan = make_plan(parse_study(study, "s.toml"), WorkFolder(folder.path()));
  const Node& node = plan.node(Stage::infer, {"Refined", 1, 1});
  RefinementCheckpoint checkpoint;
  checkpoint.state.num_draws = 300;
  std::filesystem::create_directories(node.path.parent_path());
  kRefinementCheckpointSchema.write(plan.work.checkpoint("infer", node.key), node.identity,
                                    checkpoint);
  const ArtefactStatus status = status_of(plan, node, Scrutiny::thorough);
  EXPECT_EQ(status.state, ArtefactState::partial) << status.detail;
  EXPECT_EQ(status.detail, "checkpoint at simulation 300");
  EXPECT_TRUE(status.is_sound);
  EXPECT_EQ(reasons(plan, node),
            std::vector<std::string>{"it isn't finished: checkpoint at simulation 300"});
  std::filesystem::remove(plan.work.checkpoint("infer", node.key));
  EXPECT_EQ(reasons(plan, node), std::vector<std::string>{"it was never made"});
}

TEST(ArtefactStatus, IsStaleWhereTheStudysFolderIsALink) {
  namespace fs = std::filesystem;
  const TempFolder folder, other;
  const std::string study = pendulum_study("moved").method("NPE");
  const Plan plan = make_plan(parse_study(study, "s.toml"), WorkFolder(folder.path()));
  const Node& node = plan.node(Stage::infer, {"NPE", 1, 1});
  const fs::path earlier = node.path.parent_path() / "earlier.h5";
  fs::create_directories(earlier.parent_path());
  std::ofstream(earlier) << "x";
  fs::create_directories(other / "on/another/disk");
  fs::create_directory_symlink(other / "on/another/disk", plan.work.study("moved"));
  const fs::path link = link_of(plan, node, node.uses.front());
  fs::create_directories(link.parent_path());
  fs::create_symlink(fs::relative(earlier, link.parent_path()), link);
  EXPECT_EQ(status_of(plan, node).state, ArtefactState::stale);
  EXPECT_EQ(status_of(plan, node).earlier, fs::canonical(earlier));
  fs::remove(earlier);
  EXPECT_EQ(status_of(plan, node).state, ArtefactState::missing);
  EXPECT_TRUE(says(reasons(plan, node).front(), {"an earlier version's file was removed: "}));
}

TEST(ArtefactStatus, OfAJobThatFailedQuotesAndNamesItsLog) {
  const TempFolder folder;
  const std::string study = pendulum_study("failed").method("NPE");
  const Plan plan = make_plan(parse_study(study, "s.toml"), WorkFolder(folder.path()));
  const Node& node = plan.node(Stage::infer, {"NPE", 1, 1});
  EXPECT_EQ(status_of(plan, node).detail, "");
  const std::filesystem::path log = log_of(plan, node);
  std::filesystem::create_directories(log.parent_path());
  std::ofstream(log) << "npdr-infer: no memory\n";
  const ArtefactStatus status = status_of(plan, node);
  EXPECT_EQ(status.state, ArtefactState::missing);
  EXPECT_EQ(status.detail, "what its jobs have said: " + log.string());
  EXPECT_EQ(reasons(plan, node), (std::vector<std::string>{"it was never made", status.detail}));
  log_failure(log, "another", 1, {"of an earlier study"});
  EXPECT_EQ(status_of(plan, node).state, ArtefactState::missing);
  log_failure(log, node.key, 1, {"warning: slow", "no memory", "anywhere"});
  const ArtefactStatus failed = status_of(plan, node);
  EXPECT_EQ(failed.state, ArtefactState::failed);
  EXPECT_EQ(failed.detail, "exit status 1: no memory; log: " + log.string());
  EXPECT_FALSE(failed.is_made);
  EXPECT_EQ(reasons(plan, node),
            (std::vector<std::string>{"its last run failed: " + failed.detail}));
  std::ofstream(log, std::ios::app) << "npdr-infer: goes on\n";
  EXPECT_EQ(status_of(plan, node).state, ArtefactState::missing);
}

}  // namespace
}  // namespace npdr::pipeline
