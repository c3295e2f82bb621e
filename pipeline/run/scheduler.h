/// Brings the artefacts of a plan up to date: starts what is ready, as child processes, a few at a
/// time.
#pragma once

#include <list>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/plan/plan.h"
#include "pipeline/process/child_process.h"
#include "pipeline/process/progress.h"
#include "pipeline/run/run_progress.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {

struct SchedulerConfig {
  int num_jobs = 1;                    ///< cores to keep busy
  std::optional<Stage> until;          ///< the last stage to run; empty: all
  std::vector<std::string> artefacts;  ///< keys of those to make; empty: all
};

/// The command that makes one artefact.
std::vector<std::string> stage_command(const Plan& plan, const Node& node);

/// That of a helper of the refinement `node`.
std::vector<std::string> helper_command(const Plan& plan, const Node& node, const Helper& helper);

/// The nodes that aren't complete and are needed for what is selected, in an order that works.
std::vector<const Node*> missing_nodes(const Plan& plan, std::optional<Stage> until);

/// Those of them that `config` is about. Throws InputError when one of its artefacts needs what is
/// neither there nor one of them.
std::vector<const Node*> missing_nodes(const Plan& plan, const SchedulerConfig& config);

class Scheduler {
 public:
  /// Throws InputError as missing_nodes(), Error as settle().
  Scheduler(const Plan& plan, SchedulerConfig config);

  /// Runs until all is done, something failed, or a stop was requested. Failures are printed; what
  /// doesn't depend on them is finished first. Returns the status that the program should leave
  /// with. Throws Error when a process can't be started.
  ExitStatus run();

 private:
  enum class State { waiting, running, done, failed };
  struct Job {
    Job(std::size_t index, int cores, const std::vector<std::string>& command, JobLog job_log)
        : node(index),
          threads(cores),
          log(std::move(job_log)),
          process(command, threads, log.path) {}
    std::size_t node;
    int threads;
    JobLog log;
    ChildProcess process;
    Clock::time_point start = Clock::now();
  };

  bool is_ready(std::size_t node) const;
  void start_ready_jobs();
  void start(std::size_t index, int threads);
  void wait_for_news();
  void collect_ended_jobs();
  void end_of(const Job& job);
  void pass_on_stop_request();
  /// Core-seconds of a job so far, and of what is left of it; none where nothing tells.
  static double spent(const Job& job);
  std::optional<double> left(const Job& job) const;
  std::optional<double> share_done() const;
  std::string job_text(const Job& job) const;
  void show_progress(bool force);

  const Plan& plan_;
  SchedulerConfig config_;
  std::vector<State> states_;
  std::list<Job> jobs_;
  int free_slots_;
  std::size_t num_missing_ = 0;
  std::size_t num_made_ = 0;
  ExitStatus status_ = ExitStatus::done;
  bool stopping_ = false;   ///< nothing more is started
  bool passed_on_ = false;  ///< the children were told to stop
  RunCosts costs_;
  double spent_ = 0.0;  ///< core-seconds of the jobs that have ended
  double shown_share_ = 0.0;
  LiveLines lines_;
  FailureWords failures_;
  Clock::time_point start_;
  Clock::time_point shown_;
};

}  // namespace npdr::pipeline
