// Studies that Slurm runs have the bits of local ones, whatever happens on the way.
#include "core/atomic_file.h"
#include "tests/cluster/cluster.h"

namespace npdr::pipeline {
namespace {

// Four shards a round, by a simulator that a test can hold up: the task of an array whose index
// stands in the file 'hang' never ends.
std::string slow_study() {
  return command_study("slow")
      .only("target", {"truth = { a = 0.4, b = 0.7 }"})
      .with("simulator", {"features = [\"sum\", \"difference\"]", "retries = 0"})
      .with("simulate", {"shard_size = 40"})
      .method("NPE", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 160",
                      kSmallFlow, "training = { max_epochs = 30 }"})
      .with("evaluate", {"num_samples = 50"})
      .with("cluster", {"setup = [\"[ ! -e bad-disk ] || [ \\\"$SLURM_ARRAY_TASK_ID\\\" != 2 ] "
                        "|| export NPDR_SCRATCH=/proc/no\"]"});
}

constexpr const char* kSimulator = R"sh(
if [ -e hang ] && [ "$(cat hang)" = "$SLURM_ARRAY_TASK_ID" ]; then
  touch hanging
  tail -f /dev/null
fi
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; print "sum,difference"; next }
         { printf "%.9g,%.9g\n", $column["a"] + $column["b"], $column["a"] - $column["b"] }' "$1" > "$2"
)sh";

class Submit : public ClusterTest {
 protected:
  void SetUp() override {
    ClusterTest::SetUp();
    if (IsSkipped()) return;
    write_text_file(cluster_->folder() / "simulate.sh", kSimulator);
    write_text_file(cluster_->folder() / "slow.toml", slow_study());
  }

  Outcome npdr(const std::vector<std::string>& words) const {
    return cluster_->call(joined({"npdr"}, words));
  }
  Outcome npdr(int status, const std::vector<std::string>& words,
               const std::source_location& where = std::source_location::current()) const {
    return with_status(status, npdr(words), where);
  }
  // Of a refinement that can't reach its number of effective draws: it ends with its budget.
  Outcome submit_refinement(Index num_rollouts, const std::string& settings,
                            const StudyText::Lines& cluster) const {
    const std::string refine = "refine = { level_size = 1000, min_ess = 50000" + settings + " }";
    StudyText study = furuta_study("refined")
                          .with("target", {"num_rollouts = " + std::to_string(num_rollouts)})
                          .with("observation_noise", {"scale = 0.05"})
                          .with("simulate", {"shard_size = 50"})
                          .method("Refined", {"algorithm = \"refine\"", refine})
                          .with("evaluate", {"num_samples = 50"});
    if (!cluster.empty()) study.with("cluster", cluster);
    write_text_file(cluster_->folder() / "refined.toml", std::string(study));
    return npdr(0, {"submit", "refined.toml"});
  }
  // Waits until Slurm notices that the node of a task has crashed, and starts the task elsewhere.
  void crash_node_of(const std::string& task) const {
    cluster_->command({"kill-node", cluster_->node_of(task)});
    cluster_->wait_for_state(task, "PENDING");
    cluster_->start_now(task);
    cluster_->wait_until_idle();
  }

  void hang(int task) const { write_text_file(cluster_->folder() / "hang", std::to_string(task)); }

  // The array of the first round's simulation, once its hanging task hangs.
  std::string submit_and_hang(int task) const {
    hang(task);
    const Outcome submitted = npdr(0, {"submit", "slow.toml"});
    cluster_->wait_for_file("hanging");
    std::filesystem::remove(cluster_->folder() / "hang");  // only this attempt
    const std::string line = submitted.out.substr(0, submitted.out.find("simulate NPE"));
    const std::size_t begin = line.find_last_not_of("0123456789 ");
    std::string id = line.substr(begin == std::string::npos ? 0 : begin + 1);
    id.erase(0, id.find_first_not_of(' '));
    return id.substr(0, id.find(' '));
  }

  // Log of the first submission's only training.
  std::filesystem::path log_of(const std::string& task) const {
    return cluster_->folder() / "runs/slow/jobs/001/logs" /
           ("infer-npe-seed-1-round-1-" + task + ".log");
  }

  // The task of an inference, once it works.
  std::string wait_for_inference(const std::string& study) const {
    std::string task;
    cluster_->wait_until("for an inference", [&] {
      const std::string name = "npdr-" + study + "-infer";
      const std::string queue =
          cluster_->call({"squeue", "-h", "-t", "running", "-n", name, "-o", "%i"}).out;
      task = queue.substr(0, queue.find('\n'));
      return !task.empty() && !temporaries(cluster_->folder() / "runs/.cache/infer").empty();
    });
    return task;
  }

  // A task that helps, once all do and there is something that they have made.
  std::string wait_for_helper(const std::string& study) const {
    std::string tasks;
    cluster_->wait_until("for helpers", [&] {
      const std::string name = "npdr-" + study + "-help";
      tasks =
          cluster_->call({"squeue", "-h", "-r", "-t", "running", "-n", name, "-o", "%F_%K"}).out;
      const auto made = files_ending(cluster_->folder() / "runs/.cache/infer", ".h5");
      return std::ranges::count(tasks, '\n') == 2 &&
             std::ranges::any_of(made, [](const auto& file) { return has(file, ".rows/rows-"); });
    });
    return tasks.substr(0, tasks.find('\n'));
  }

  std::string helper_logs(const std::string& study) const {
    std::string text;
    const std::filesystem::path logs = cluster_->folder() / "runs" / study / "jobs/001/logs";
    for (const std::string& name : files_ending(logs, ".log")) {
      if (name.starts_with("help-")) text += text_of(logs / name);
    }
    return text;
  }

  bool has_checkpoint() const {
    const std::filesystem::path folder = cluster_->folder() / "runs/.cache/infer";
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
      const std::string name = entry.path().filename();
      if (has(name, ".checkpoint.h5") && name.front() != '.') return true;
    }
    return false;
  }

  void expect_bits_of_a_local_run(const std::string& study = "slow") const {
    const Outcome local = npdr(0, {"run", study + ".toml", "--work", "local"});
    EXPECT_EQ(digests(cluster_->folder() / "runs" / study),
              digests(cluster_->folder() / "local" / study));
  }
};

TEST_F(Submit, AStudyHasTheBitsOfALocalRun) {
  write_text_file(cluster_->folder() / "small.toml", std::string(small_study()));
  const Outcome submitted =
      npdr(0, {"submit", "small.toml", "--wait", "--set", "simulate.shard_size=40"});
  // What the checks say, nothing of this study, and where the report is.
  const std::string end = "\nreport: runs/small/report.html\n";
  EXPECT_TRUE(submitted.out.ends_with(end)) << submitted.out;
  const Outcome again = npdr({"submit", "small.toml", "--set", "simulate.shard_size=40"});
  EXPECT_EQ(again.out, "small: nothing to submit, all is up to date\n" + end);
  expect_bits_of_a_local_run("small");
}

TEST_F(Submit, WhatIsQueuedIsntSubmittedTwiceAndCanBeCanceled) {
  npdr(0, {"submit", "slow.toml", "--sbatch=--hold"});
  const Outcome second = npdr({"submit", "slow.toml"});
  EXPECT_TRUE(has(second.out, "nothing to submit"));
  EXPECT_TRUE(has(npdr({"status", "slow.toml"}).out, "queued ("));
  // Also by somebody who has changed the study meanwhile.
  const Outcome canceled = npdr({"cancel", "slow.toml", "--set", "target.truth.a=0.5"});
  EXPECT_TRUE(has(canceled.out, "tasks canceled")) << canceled.err;
  EXPECT_FALSE(has(canceled.out, " 0 tasks")) << canceled.out;
  cluster_->wait_until_idle();
  EXPECT_TRUE(has(npdr({"submit", "slow.toml", "--dry-run"}).out, "sbatch --parsable --array=0-3"));
}

TEST_F(Submit, AStudySurvivesTheCrashOfANode) {
  const std::string task = submit_and_hang(1) + "_1";
  EXPECT_TRUE(has(npdr({"status", "slow.toml"}).out, "running"));
  crash_node_of(task);
  expect_bits_of_a_local_run();
}

TEST_F(Submit, ARefinementSurvivesTheCrashOfItsNode) {
  submit_refinement(1, ", max_simulations = 4000", {});
  const std::string task = wait_for_inference("refined");
  crash_node_of(task);
  expect_bits_of_a_local_run("refined");
}

// One helper is killed while it works: what it would have made others make.
TEST_F(Submit, ARefinementWithHelpersHasTheBitsOfALocalRun) {
  const Outcome submitted = submit_refinement(10, ", max_simulations = 3000", {"refine_tasks = 2"});
  EXPECT_TRUE(has(submitted.out, "help infer Refined, seed 1, round 1, 2 tasks"));
  const Outcome again = npdr({"submit", "refined.toml"});
  EXPECT_TRUE(has(again.out, "nothing to submit")) << again.out << again.err;

  const std::string helper = wait_for_helper("refined");
  cluster_->kill_shell_of(helper, SIGKILL);
  cluster_->wait_until_idle();
  const std::string status = npdr({"status", "refined.toml"}).out;
  EXPECT_FALSE(has(status, "failed")) << status;
  EXPECT_TRUE(npdr({"submit", "refined.toml"})
                  .out.starts_with("refined: nothing to submit, all is up to date\n"));
  EXPECT_TRUE(has(helper_logs("refined"), "helped with ")) << helper_logs("refined");
  expect_bits_of_a_local_run("refined");
}

TEST_F(Submit, HelpersThatFailAreToldAndTheOthersCanceledWithTheirRefinement) {
  submit_refinement(1, "", {"refine_tasks = 2"});
  const std::string helper = wait_for_helper("refined");
  EXPECT_TRUE(has(npdr({"status", "refined.toml"}).out, ", 2 helpers"));
  cluster_->kill_shell_of(helper, SIGKILL);
  cluster_->wait_until("for a helper's end", [&] {
    return has(npdr({"status", "refined.toml"}).out, ", 1 helper; 1 helper failed, job " + helper);
  });
  const std::string status = npdr({"status", "refined.toml"}).out;
  EXPECT_TRUE(has(status, "1 running"));
  EXPECT_TRUE(has(npdr({"cancel", "refined.toml"}).out, "tasks canceled"));
  cluster_->wait_until_idle();
}

TEST_F(Submit, ATaskThatIsKilledIsAllThatIsSubmittedAgain) {
  const std::string task = submit_and_hang(2) + "_2";
  cluster_->kill_shell_of(task, SIGKILL);
  cluster_->wait_until_idle();
  const std::string status = npdr({"status", "slow.toml"}).out;
  EXPECT_TRUE(has(status, {"3 of 4 shards", "job " + task + ": ", task + ".log"}));
  npdr(0, {"submit", "slow.toml", "--wait"});
  expect_bits_of_a_local_run();
}

TEST_F(Submit, AFailedShardSaysWhyAndDoesntHang) {
  write_text_file(cluster_->folder() / "bad-disk", "");
  const Outcome failed = npdr(1, {"submit", "slow.toml", "--wait"});
  EXPECT_TRUE(
      has(failed.err, {"simulate NPE, seed 1, round 1 failed: job ", "exit status 1", "/proc/no"}));
  EXPECT_TRUE(has(npdr({"status", "slow.toml"}).out, "failed"));
  std::filesystem::remove(cluster_->folder() / "bad-disk");
  EXPECT_EQ(npdr({"submit", "slow.toml", "--wait"}).status, 0);
  expect_bits_of_a_local_run();
}

// Jobs that wait for the whole array can no longer begin, while a task of it still runs.
TEST_F(Submit, AgainAfterAFailureBringsBackWhatWaitsInVain) {
  write_text_file(cluster_->folder() / "bad-disk", "");
  const std::string array = submit_and_hang(3);
  cluster_->wait_for_state(array + "_2", "FAILED");
  std::filesystem::remove(cluster_->folder() / "bad-disk");
  const Outcome again = npdr({"submit", "slow.toml"});
  EXPECT_TRUE(has(again.out, "waited in vain")) << again.out << again.err;
  EXPECT_EQ(cluster_->call({"scancel", "-b", "-s", "USR1", array + "_3"}).status, 0);
  cluster_->wait_until_idle();
  expect_bits_of_a_local_run();
}

TEST_F(Submit, ATaskNearItsTimeLimitIsQueuedAgain) {
  const std::string task = submit_and_hang(0) + "_0";
  EXPECT_EQ(cluster_->call({"scancel", "-b", "-s", "USR1", task}).status, 0);
  cluster_->wait_until_idle();
  expect_bits_of_a_local_run();
}

// Training goes on from its checkpoint.
TEST_F(Submit, ATrainingNearItsTimeLimitGoesOnWhereItWas) {
  const std::string text = edited(text_of(cluster_->folder() / "slow.toml"), "max_epochs = 30",
                                  "max_epochs = 15000, stop_after_epochs = 15000");
  write_text_file(cluster_->folder() / "slow.toml",
                  edited(text, "num_rounds = 2", "num_rounds = 1"));
  npdr(0, {"submit", "slow.toml"});
  const std::string task = wait_for_inference("slow");
  EXPECT_EQ(cluster_->call({"scancel", "-b", "-s", "USR1", task}).status, 0);
  cluster_->wait_until("for a checkpoint", [&] { return has_checkpoint(); });
  cluster_->wait_until_idle();
  EXPECT_TRUE(has(text_of(log_of(task)), "npdr task: asks to be queued again"))
      << text_of(log_of(task));
  expect_bits_of_a_local_run();
}

TEST_F(Submit, AStudySurvivesTheCrashOfTheController) {
  submit_and_hang(3);
  cluster_->wait_until_saved();
  cluster_->command({"kill-controller"});
  EXPECT_TRUE(has(npdr(0, {"status", "slow.toml"}).err, "what is queued isn't known"));
  EXPECT_EQ(cluster_->command({"start-controller"}).status, 0);
  EXPECT_TRUE(has(npdr({"submit", "slow.toml"}).out, "nothing to submit"));
  EXPECT_TRUE(has(npdr({"cancel", "slow.toml"}).out, "tasks canceled"));
  cluster_->wait_until_idle();
  EXPECT_EQ(npdr({"submit", "slow.toml", "--wait"}).status, 0);
  expect_bits_of_a_local_run();
}

}  // namespace
}  // namespace npdr::pipeline
