#include "tests/cluster/cluster.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

using OneMachineCluster = ClusterTest;

TEST_F(OneMachineCluster, EachNodeHasItsOwnName) {
  for (const std::string node : {"n1", "n2", "n3"}) {
    cluster_->submit("hostname > host-$SLURMD_NODENAME.txt", {"--nodelist=" + node});
  }
  cluster_->wait_until_idle();
  for (const std::string node : {"n1", "n2", "n3"}) {
    EXPECT_EQ(text_of(cluster_->folder() / ("host-" + node + ".txt")), node + "\n");
  }
}

TEST_F(OneMachineCluster, TwoRunSideBySide) {
  const Cluster other;
  other.submit("tail -f /dev/null");
  EXPECT_EQ(other.states().size(), 1u);
  EXPECT_EQ(cluster_->states().size(), 0u);
  EXPECT_EQ(other.command({"status"}).status, 0);
  EXPECT_EQ(cluster_->command({"status"}).status, 0);
}

TEST_F(OneMachineCluster, DownLeavesNoProcessAndNoFile) {
  cluster_->submit("touch started-$SLURM_ARRAY_TASK_ID; tail -f /dev/null", {"--array=0-2"});
  for (const char* file : {"started-0", "started-1", "started-2"}) cluster_->wait_for_file(file);
  const std::vector<pid_t> before = cluster_->processes();
  // munged, slurmctld and the keeper; for each node its first process, slurmd, a step and a shell.
  EXPECT_GE(before.size(), 3u + 3u * 4u);

  const Outcome down = cluster_->command({"down"});
  EXPECT_EQ(down.status, 0) << down.err;
  EXPECT_EQ(cluster_->processes(), std::vector<pid_t>());
  for (const pid_t process : before) EXPECT_TRUE(has_ended(process)) << process;
  EXPECT_FALSE(fs::exists(cluster_->root()));
  EXPECT_EQ(cluster_->command({"down"}).status, 0);
}

TEST_F(OneMachineCluster, DownAlsoCleansUpAfterAKilledUp) {
  cluster_->command({"down"});
  for (const std::string last :
       {"slurm.conf", "run/munged.process", "run/slurmctld.process", "run/n1.process"}) {
    const Program up(cluster_->folder(), {fs::path(NPDR_SOURCE_DIR) / "jobs/one-machine-cluster",
                                          "--root", cluster_->root(), "up"});
    cluster_->wait_until("for " + last, [&] { return fs::exists(cluster_->root() / last); });
    up.send(SIGKILL);
    up.wait();
    const Outcome down = cluster_->command({"down"});
    EXPECT_EQ(down.status, 0) << down.err;
    EXPECT_FALSE(fs::exists(cluster_->root()));
    cluster_->wait_until("for an end after " + last, [&] { return cluster_->processes().empty(); });
  }
}

TEST_F(OneMachineCluster, GoesDownWithTheProcessThatItWatches) {
  cluster_->command({"down"});
  const Program watched(cluster_->folder(), {"/usr/bin/tail", "-f", "/dev/null"});
  const Outcome up = cluster_->command({"up", "--while", std::to_string(watched.pid())});
  EXPECT_EQ(up.status, 0) << up.err;
  EXPECT_EQ(cluster_->command({"status"}).status, 0);
  watched.send(SIGKILL);
  watched.wait();
  cluster_->wait_until("for an end", [&] { return cluster_->processes().empty(); });
  EXPECT_FALSE(fs::exists(cluster_->root()));
}

TEST_F(OneMachineCluster, StatusTellsWhatIsDead) {
  EXPECT_EQ(cluster_->command({"status"}).status, 0);
  EXPECT_EQ(cluster_->command({"kill-node", "n2"}).status, 0);
  const Outcome status = cluster_->command({"status"});
  EXPECT_EQ(status.status, 1);
  EXPECT_TRUE(has(status.out, "n1         process"));
  EXPECT_FALSE(has(status.out, "n2         process"));
  EXPECT_EQ(cluster_->command({"start-node", "n2"}).status, 0);
  EXPECT_EQ(cluster_->command({"status"}).status, 0);
}

TEST_F(OneMachineCluster, SaysWhatIsWrong) {
  const auto expect = [&](const std::vector<std::string>& words, int status, const char* message) {
    const Outcome outcome = cluster_->command(words);
    EXPECT_EQ(outcome.status, status) << words.back();
    EXPECT_TRUE(has(outcome.err, message));
  };
  expect({"up"}, 1, "there is a cluster at ");
  expect({"up", "--nodes", "0"}, 2, "--nodes 0: must be a number from 1 to 100");
  expect({"up", "--nodes"}, 2, "--nodes needs a value");
  expect({"jump"}, 2, "unknown command 'jump'");
  expect({"kill-node", "n4"}, 2, "no node 'n4', only n1 n2 n3");
  expect({"start-node", "n1"}, 1, "n1 runs already");
  expect({"start-controller"}, 1, "slurmctld runs already");
  expect({"--root", cluster_->folder(), "status"}, 1, "there is no cluster at ");
  expect({"--root", cluster_->folder() / "a b", "check"}, 2, "only letters, digits");
  expect({"--root", cluster_->folder() / "missing/c", "check"}, 2, "there is no folder ");

  std::ofstream(cluster_->folder() / "precious") << "text";
  expect({"--root", cluster_->folder(), "up"}, 1, "isn't empty; choose another --root");
  expect({"--root", cluster_->folder(), "down"}, 1, "isn't the folder of a cluster");
  EXPECT_TRUE(fs::exists(cluster_->folder() / "precious"));
  fs::permissions(cluster_->folder(), static_cast<fs::perms>(0777));
  expect({"--root", cluster_->folder() / "c", "check"}, 1, "has mode 777, must be 755");
}

}  // namespace
}  // namespace npdr::pipeline
