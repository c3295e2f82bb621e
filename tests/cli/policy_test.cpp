#include <csignal>

#include "pipeline/artefacts/recording.h"
#include "tests/cli/study_run.h"

namespace npdr::pipeline {
namespace {

// Short rollouts and few candidates: what counts is that everything takes part. One method collects
// rollouts with its policy and infers again, one infers nothing.
StudyText searched_study() {
  return furuta_study("searched")
      .with("study", {"seeds = [1, 2]"})
      .with("target", {"truth = { pole_mass = 0.02 }"})
      .with("simulator", {"segment_length = 200", "store_every = 25"})
      .with("prior", {"pole_length = { uniform = [0.1, 0.15] }"})
      .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]"});
}

StudyText& with_online(StudyText& study, const StudyText::Lines& more) {
  StudyText::Lines lines = {"num_simulations = 60",
                            "embedding = { kind = \"all_steps\", downsample = 125 }", kSmallMixture,
                            "training = { max_epochs = 5, batch_size = 20 }"};
  lines.insert(lines.end(), more.begin(), more.end());
  return study.method("Online", lines);
}

StudyText& with_search(StudyText& study) {
  return study.method("Randomized", {"algorithm = \"prior\"", "policy_iterations = 4"})
      .method("Point", {"algorithm = \"nominal\"", "policy_iterations = 4"})
      .with("policy", few_trials())
      .with("policy", {"population = 5", "num_domain_parameters = 4", "num_steps = 150"})
      .with("policy.grid",
            {"x = { parameter = \"pole_mass\", range = [0.0168, 0.0312], steps = 3 }",
             "y = { parameter = \"pole_length\", values = [0.1, 0.15] }"});
}

class Policies : public StudyRun {
 protected:
  static void SetUpTestSuite() {
    StudyText study = searched_study();
    with_search(with_online(study, {"num_iterations = 2", "policy_iterations = 3"}));
    const OmpThreads one(1);
    run_study("searched.toml", study, {"--jobs", "1"});
    reference_ = digests(file("runs/searched"));
  }

  static std::map<std::string, std::string> reference_;
};
std::map<std::string, std::string> Policies::reference_;

TEST_F(Policies, TheReportHasTablesAndFigures) {
  const std::string table = text_of(file("runs/searched/tables/policy.md"));
  EXPECT_TRUE(has(
      table, {"| Online ", "| Randomized ", "| Point ", "return before", "return, seed means",
              "success over the grid", "target rollouts", "policy rollouts", "upright within"}));
  EXPECT_TRUE(has(run_output_, "success over the grid"));
  // Rollouts: (3 iterations x 6 policies + 1) x 4 x 2, twice; once with 4 iterations; and so for
  // the nominal parameters, whose rollouts all have their own initial states.
  const std::string csv = text_of(file("runs/searched/tables/policy.csv"));
  EXPECT_TRUE(has(csv, {",2,120,304", ",0,0,200"}));
  const std::string seeds = text_of(file("runs/searched/tables/policy_seeds.md"));
  EXPECT_TRUE(has(seeds, "| Point, 2 "));
  EXPECT_TRUE(has(text_of(file("runs/searched/tables/policy_cost.md")), "policy search"));
  const std::string found = text_of(file("runs/searched/tables/policy_parameters.csv"));
  EXPECT_TRUE(has(found, {"energy_gain [m/(s^2 J)]", "before any search,", "\"Online, 2\","}));
  const std::string report = text_of(file("runs/searched/report.html"));
  EXPECT_TRUE(has(report, {"Policies", "search iteration", "before any search"}));
  for (const char* name : {"policy_learning", "policy_grid_return", "policy_grid_success"}) {
    for (const char* extension : {".svg", ".png", ".gp"}) {
      EXPECT_TRUE(
          std::filesystem::exists(file("runs/searched/figures") / (std::string(name) + extension)))
          << name;
    }
  }
}

TEST_F(Policies, EveryArtefactHasALink) {
  // target, baseline; of each seed the test before any search, with a link for each of 3 methods,
  // and of Online 2 x (propose, simulate, infer, policy), a target, an evaluation and a test, of
  // the two others a policy and a test.
  EXPECT_EQ(reference_.size(), 2u + 2u * (3 + 2 * 4 + 1 + 1 + 1 + 2 * 2));
  for (const char* name :
       {"online/seed-1/iteration-2/target.h5", "online/seed-2/iteration-2/round-1/infer.h5",
        "online/seed-1/iteration-2/policy_test.h5", "randomized/seed-2/iteration-1/policy.h5",
        "point/seed-1/policy_test.h5"}) {
    EXPECT_TRUE(reference_.contains(name)) << name;
  }
  const Outcome status = npdr({"status", "searched.toml"});
  EXPECT_TRUE(has(status.out, {" up to date;", "policy Online, seed 1, iteration 2"}));
}

TEST_F(Policies, SameBitsForAnyThreadCountAndShardSize) {
  const OmpThreads three(3);
  npdr(0, {"run", "searched.toml", "--work", "three", "--jobs", "3", "--set",
           "simulate.shard_size=17"});
  EXPECT_EQ(digests(file("three/searched")), reference_);
  for (const std::string table : {"policy.csv", "policy_seeds.csv", "fit.csv"}) {
    EXPECT_EQ(text_of(file("three/searched/tables/" + table)),
              text_of(file("runs/searched/tables/" + table)))
        << table;
  }
}

TEST_F(Policies, CanBeSearchedForByHand) {
  for (const std::string stage : {"propose", "simulate", "infer", "policy", "propose", "simulate",
                                  "infer", "policy", "evaluate", "report"}) {
    with_status(0, run(folder_->path(), {"npdr-" + stage, "searched.toml", "--work", "hand"}));
  }
  EXPECT_EQ(digests(file("hand/searched")), reference_);
}

TEST_F(Policies, AnEarlyStartSaysWhatIsMissing) {
  const std::vector<std::string> words = {"npdr-policy", "searched.toml", "--work",
                                          "early",       "--only",        "Online"};
  EXPECT_EQ(run(folder_->path(), words).status, 0) << "one before any search can be tested";
  EXPECT_TRUE(has(with_status(2, run(folder_->path(), words)).err,
                  "policy Online, seed 1, iteration 1 needs 'infer Online, seed 1, "
                  "iteration 1, round 1', which isn't there; run npdr-infer"));
}

TEST_F(Policies, MethodsThatInferNothingCanStandAlone) {
  StudyText study = searched_study();
  std::ofstream(file("alone.toml")) << with_search(study);
  EXPECT_TRUE(has(npdr(0, {"run", "alone.toml", "--work", "alone"}).out, "| Randomized "));
  EXPECT_FALSE(std::filesystem::exists(file("alone/searched/tables/fit.md")));
}

TEST_F(Policies, PosteriorsOfTheLastIterationAreExported) {
  npdr(0, {"export", "searched.toml", "--only", "Online", "-o", "online.nc"});
}

// A loop closed every 4 ms has other delays than a recording of every 8 ms.
TEST_F(Policies, InputsOfAnotherTimeStepAreRefused) {
  Target slower = read_recording(file("runs/searched/target.h5"));
  slower.dt *= 2.0;
  write_recording(slower, file("slower.h5"));
  EXPECT_TRUE(says(
      npdr(2, {"run", "searched.toml", "--set", "target.inputs=" + file("slower.h5").string()}).err,
      {"npdr run: --set target.inputs=", "dt = 0.008 s", "must be 0.004 s with [policy]"}));
}

TEST_F(Policies, SimulationsOfARefinementCount) {
  StudyText study = searched_study().with("observation_noise", {"scale = 0.05"});
  study.method("Refined",
               {"algorithm = \"refine\"", "policy_iterations = 1",
                "refine = { level_size = 1000, min_ess = 100, max_simulations = 3000 }"});
  std::ofstream(file("refined.toml")) << with_search(study);
  npdr(0, {"run", "refined.toml", "--work", "refined", "--only", "Refined", "--seeds", "1"});
  const std::string policies = text_of(file("refined/searched/tables/policy.csv"));
  const std::string certificate = text_of(file("refined/searched/tables/refinement.csv"));
  const std::size_t at = certificate.find(",too few simulations to search");
  ASSERT_NE(at, std::string::npos) << certificate;  // 1000 of them don't reach the power 1
  const std::size_t before = certificate.rfind(',', at - 1);
  const std::string count = certificate.substr(before, at - before);
  EXPECT_TRUE(has(policies, ",1" + count + ",")) << certificate;
}

// A search that takes long, of one method and seed; it ends when it is told to.
class LongSearch : public Policies {
 protected:
  static std::vector<std::string> words(const std::string& program, const std::string& work) {
    return {program,   "searched.toml",
            "--work",  work,
            "--only",  "Randomized",
            "--seeds", "1",
            "--set",   "method.Randomized.policy_iterations=60",
            "--set",   "policy.population=40"};
  }
  static std::string digest(const std::string& work) {
    return content_digest(file(work + "/searched/randomized/seed-1/iteration-1/policy.h5"));
  }
  static std::filesystem::path cache(const std::string& work) {
    return file(work) / ".cache/policy";
  }

  // Waits until the program has done an iteration more.
  static void wait_for_checkpoint(const Program& program, const std::string& work) {
    const auto saved = [&] {
      std::map<std::string, std::filesystem::file_time_type> times;
      for (const std::string& name : files_ending(cache(work), ".checkpoint.h5")) {
        std::error_code gone;
        times[name] = std::filesystem::last_write_time(cache(work) / name, gone);
      }
      return times;
    };
    const auto before = saved();
    EXPECT_TRUE(comes_true([&] { return program.has_ended() || saved() != before; }));
  }

  // Ends some runs by `signal`, each after at least an iteration.
  static void interrupt(int signal, const std::string& work) {
    for (int i = 0; i < 4; ++i) {
      const Program program(folder_->path(), words("npdr-policy", work));
      wait_for_checkpoint(program, work);
      program.send(signal);
      EXPECT_EQ(program.wait().status, signal == SIGKILL ? 128 + SIGKILL : 75)
          << "the search must take longer";
    }
  }
};

TEST_F(LongSearch, GoesOnWithTheSameBits) {
  with_status(0, run(folder_->path(), words("npdr-policy", "whole")));
  for (const int signal : {SIGKILL, SIGTERM}) {
    const std::string work = "by-" + std::to_string(signal);
    interrupt(signal, work);
    with_status(0, run(folder_->path(), words("npdr-policy", work)));
    EXPECT_EQ(digest(work), digest("whole")) << signal;
    EXPECT_EQ(files_ending(cache(work), ".checkpoint.h5"), std::set<std::string>());
  }
}

TEST_F(LongSearch, StopsAtACheckpointThatTheStatusShows) {
  std::vector<std::string> endless =
      joined(words("npdr-policy", "stopped"), {"--set", "method.policy_iterations=100000"});
  const Program program(folder_->path(), endless);
  wait_for_checkpoint(program, "stopped");
  program.send(SIGTERM);
  with_status(75, program.wait());
  endless.front() = "status";
  EXPECT_TRUE(has(npdr(endless).out, "checkpoint at iteration"));
}

}  // namespace
}  // namespace npdr::pipeline
