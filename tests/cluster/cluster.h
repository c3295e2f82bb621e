/// A Slurm cluster of a test's own: jobs/one-machine-cluster, and what tests ask of it and do to
/// it.
///
/// Needs root and the packages of scripts/install-deps --cluster; a ClusterTest is skipped where it
/// can't run. It is gone when the test is, even one that is killed. Everything that waits gives up
/// after a minute: the test fails and says what the cluster was doing.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/cli/program.h"

namespace npdr::pipeline {

class Cluster {
 public:
  /// Three nodes, n1 to n3, each with more processors than tests have tasks: slurmctld starts jobs
  /// once a second, so it is waves of tasks that take time.
  Cluster();
  ~Cluster();
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  /// Why no cluster can run here; "" if one can.
  static std::string hindrance();

  /// jobs/one-machine-cluster with this cluster's folder.
  Outcome command(std::vector<std::string> words) const;
  /// A program, of Slurm or of the project, in the folder of the jobs.
  Outcome call(std::vector<std::string> words) const;

  /// Place where jobs are submitted and leave their files.
  std::filesystem::path folder() const { return folder_ / "work"; }
  /// The cluster's own.
  std::filesystem::path root() const { return folder_ / "cluster"; }

  /// Submits a bash script by sbatch with more options; the job's id, of an array the array's.
  std::string submit(const std::string& script, const std::vector<std::string>& options = {}) const;

  /// State of each job or task ("12", "12_3") that Slurm knows of, ended ones included.
  std::map<std::string, std::string> states() const;
  std::string state(const std::string& task) const;
  /// Node that it runs on.
  std::string node_of(const std::string& task) const;

  /// `what` is for the message, should `done` not come true.
  void wait_until(const std::string& what, const std::function<bool()>& done) const;
  void wait_for_state(const std::string& task, const std::string& state) const;
  /// Until no job is queued or runs.
  void wait_until_idle() const;
  /// Until a job has written the file; its place is seen from the folder of the jobs.
  void wait_for_file(const std::string& file) const;

  /// Waits until Slurm would know of all jobs again after a crash of its controller.
  void wait_until_saved() const;
  /// Sends the signal to the batch shell that runs the task, past Slurm.
  void kill_shell_of(const std::string& task, int signal) const;
  /// Starts a task of a dead node elsewhere that Slurm has put back into the queue, without the
  /// usual wait. Not for other tasks: a node refuses one that has ended on it within the same
  /// second.
  void start_now(const std::string& task) const;

  /// All processes on this machine that belong to the cluster, daemons and jobs.
  std::vector<pid_t> processes() const;

 private:
  TempFolder folder_;
};

/// A test with a cluster.
class ClusterTest : public ::testing::Test {
 protected:
  void SetUp() override;
  std::unique_ptr<Cluster> cluster_;
};

}  // namespace npdr::pipeline
