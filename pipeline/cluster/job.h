/// The jobs that a batch system has to run so that a study gets done.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// One batch job. Either it makes whole artefacts, one after the other, or it is an array whose
/// tasks simulate shards, or one whose tasks help a refinement.
struct Job {
  std::vector<std::size_t> nodes;      ///< positions in the plan, each after those it needs
  std::vector<std::size_t> needs;      ///< positions in the list of jobs, all before this one
  std::vector<std::string> after_ok;   ///< ids of jobs that the cluster has already
  std::vector<std::string> after_any;  ///< the same of arrays, of which some tasks may have failed
  /// Helpers' alone: the refinement's job, a position in the list or an id. They begin when it has
  /// begun: earlier there is nothing to help with.
  std::vector<std::size_t> helps;
  std::vector<std::string> helps_queued;
  /// Tasks of an array: t simulates shards t * shards_per_task, ..., as far as there are any.
  std::vector<Index> tasks;
  Index shards_per_task = 0;
  Index first_task = 0;  ///< added to the index that the batch system gives a task

  bool is_helper() const { return !helps.empty() || !helps_queued.empty(); }
  bool is_array() const { return shards_per_task > 0 || is_helper(); }
};

/// Jobs that a batch system has for a node already: waiting or running.
struct InFlight {
  std::vector<std::string> jobs = {};  ///< ids of those that make it
  Index shards_per_task = 0;           ///< of an array
  std::set<Index> shards = {};         ///< of a simulation; empty for other nodes
  std::set<std::string> helpers = {};  ///< ids of those that help to make it

  bool is_made() const { return !jobs.empty(); }
};

/// The state of a study that jobs are made from.
struct JobsInput {
  const Plan& plan;
  std::optional<Stage> until;          ///< the last stage; empty: all
  std::vector<InFlight> in_flight;     ///< for each node of the plan
  std::vector<Index> shards_per_task;  ///< for each node; of simulations >= 1
  Index max_array_size = 1001;         ///< one more than the largest index of an array
};

/// The jobs for what is missing and not in flight, in an order in which they can be submitted:
///   prepare   targets and first proposals, which take a moment
///   array     the missing shards of one simulation
///   job       one artefact of another stage; a posterior's with the simulation it joins, and the
///             proposal that is drawn from it
///   helpers   cluster.refine_tasks tasks beside the job of a refinement; nothing waits for them
/// A chain of rounds is a chain of jobs; methods and seeds go on side by side.
std::vector<Job> make_jobs(const JobsInput& input);

/// Label of a job of several targets and proposals.
inline constexpr const char* kPrepareLabel = "prepare";

/// Name of a job for people: the label of its main artefact, or kPrepareLabel; "help ..." of
/// helpers.
std::string label_of(const Plan& plan, const Job& job);

/// The stage whose resources a job asks for.
Stage stage_of(const Plan& plan, const Job& job);

}  // namespace npdr::pipeline
