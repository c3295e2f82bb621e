// Promises of Slurm that the project relies on when jobs or machines fail.
#include <sys/stat.h>

#include "tests/cluster/cluster.h"

namespace npdr::pipeline {
namespace {

class Jobs : public ClusterTest {
 protected:
  // Submits a job that leaves a file 'after' once all of `job` has succeeded.
  std::string submit_after(const std::string& job) const {
    return cluster_->submit("touch after",
                            {"--dependency=afterok:" + job, "--kill-on-invalid-dep=yes"});
  }
  bool after() const { return std::filesystem::exists(cluster_->folder() / "after"); }

  // Makes the pipe 'go'. Jobs wait for a byte of it, each for one.
  void SetUp() override {
    ClusterTest::SetUp();
    if (IsSkipped()) return;
    ASSERT_EQ(mkfifo((cluster_->folder() / "go").c_str(), 0600), 0);
    go_ = open((cluster_->folder() / "go").c_str(), O_RDWR);
  }
  void TearDown() override { close(go_); }
  void let_go(const std::string& bytes) const {
    EXPECT_EQ(write(go_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }

 private:
  int go_ = -1;
};

TEST_F(Jobs, ADependentStartsAfterAllOfAnArray) {
  const std::string array = cluster_->submit(
      "[ $SLURM_ARRAY_TASK_ID != 7 ] || read < go; touch done-$SLURM_ARRAY_TASK_ID",
      {"--array=1-7%4"});
  const std::string dependent =
      cluster_->submit("ls done-* | wc -l > count.txt", {"--dependency=afterok:" + array});
  for (int task = 1; task <= 6; ++task) {
    cluster_->wait_for_file("done-" + std::to_string(task));
  }
  // Slurm has looked once more at what may start.
  cluster_->submit("touch other");
  cluster_->wait_for_file("other");
  EXPECT_EQ(cluster_->state(dependent), "PENDING");
  let_go("\n");
  cluster_->wait_until_idle();
  EXPECT_EQ(text_of(cluster_->folder() / "count.txt"), "7\n");
  EXPECT_EQ(cluster_->state(dependent), "COMPLETED");
}

// Hangs in the first attempt at task 1 until the test is done.
constexpr const char* kFirstAttemptHangs =
    "touch started-$SLURM_ARRAY_TASK_ID-${SLURM_RESTART_COUNT:-0}\n"
    "[ $SLURM_ARRAY_TASK_ID != 1 ] || [ -n \"$SLURM_RESTART_COUNT\" ] || tail -f /dev/null\n";

TEST_F(Jobs, TasksOfACrashedNodeRunElsewhere) {
  const std::string array = cluster_->submit(kFirstAttemptHangs, {"--array=0-2", "--requeue"});
  submit_after(array);
  cluster_->wait_for_file("started-1-0");
  const std::string task = array + "_1";
  const std::string node = cluster_->node_of(task);
  cluster_->command({"kill-node", node});
  cluster_->start_now(task);  // as soon as the crash is noticed
  cluster_->wait_for_file("started-1-1");
  cluster_->wait_until_idle();
  EXPECT_EQ(cluster_->state(task), "COMPLETED");
  EXPECT_TRUE(after());
}

TEST_F(Jobs, ACrashedControllerGoesOn) {
  const std::string array = cluster_->submit(
      "touch started-$SLURM_ARRAY_TASK_ID; read < go; touch done-$SLURM_ARRAY_TASK_ID",
      {"--array=0-2"});
  submit_after(array);
  for (const std::string task : {"0", "1", "2"}) cluster_->wait_for_file("started-" + task);
  cluster_->wait_until_saved();
  cluster_->command({"kill-controller"});
  EXPECT_NE(cluster_->call({"scontrol", "ping"}).status, 0);
  let_go("\n\n\n");
  for (const std::string task : {"0", "1", "2"}) cluster_->wait_for_file("done-" + task);
  const Outcome start = cluster_->command({"start-controller"});
  EXPECT_EQ(start.status, 0) << start.err;
  cluster_->wait_until_idle();
  EXPECT_TRUE(after());
}

TEST_F(Jobs, AKilledTaskTakesItsDependentsAlong) {
  const std::string array = cluster_->submit(kFirstAttemptHangs, {"--array=0-2", "--requeue"});
  const std::string first = submit_after(array);
  const std::string second = submit_after(first);
  cluster_->wait_for_file("started-1-0");
  cluster_->kill_shell_of(array + "_1", SIGKILL);
  cluster_->wait_until_idle();
  EXPECT_EQ(cluster_->state(array + "_0"), "COMPLETED");
  EXPECT_EQ(cluster_->state(array + "_1"), "FAILED");
  EXPECT_EQ(cluster_->state(first), "CANCELLED");
  EXPECT_EQ(cluster_->state(second), "CANCELLED");
  EXPECT_FALSE(after());
}

TEST_F(Jobs, ATaskThatRequeuesItselfKeepsItsDependents) {
  const std::string script =
      "trap 'scontrol requeue ${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID; exit 75' USR1\n"
      "touch started-$SLURM_ARRAY_TASK_ID-${SLURM_RESTART_COUNT:-0}\n"
      "[ -n \"$SLURM_RESTART_COUNT\" ] || { tail -f /dev/null & wait; }\n";
  const std::string array = cluster_->submit(script, {"--array=0-2", "--requeue"});
  submit_after(array);
  // All, as one of them has the job id of the array, which would be the wrong one to requeue.
  for (const std::string index : {"0", "1", "2"}) {
    cluster_->wait_for_file("started-" + index + "-0");
    cluster_->call({"scancel", "--batch", "--signal=USR1", array + "_" + index});
    cluster_->wait_for_state(array + "_" + index, "PENDING");
  }
  cluster_->wait_until_idle();
  for (const std::string index : {"0", "1", "2"}) {
    EXPECT_EQ(cluster_->state(array + "_" + index), "COMPLETED");
    EXPECT_FALSE(std::filesystem::exists(cluster_->folder() / ("started-" + index + "-2")));
  }
  EXPECT_TRUE(after());
}

}  // namespace
}  // namespace npdr::pipeline
