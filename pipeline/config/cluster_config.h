/// How a batch system is asked to run a study: the table [cluster] of a study or of a site's file.
/// No artefact depends on it.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::pipeline {

/// Tasks that may help one refinement: an array of a cluster with usual settings.
inline constexpr Index kMostHelpers = 1000;

/// Resources that a job of one stage asks for. Empty, or 0: as the whole [cluster] says.
struct StageResources {
  Index cpus = 0;                   ///< cores of a task
  std::string memory;               ///< a task's, such as "2G"
  std::string time;                 ///< limit of a task, such as "01:00:00"
  std::vector<std::string> sbatch;  ///< further options, such as "--constraint=avx512"
};

struct ClusterConfig {
  std::string partition;  ///< "": the site's default; so for all texts
  std::string account;
  Index cpus = 1;  ///< cores of a task
  std::string memory;
  std::string time;
  Index array_limit = 0;            ///< tasks of an array at the same time; 0: no limit
  Index max_array_size = 0;         ///< a larger array is split; 0: the cluster is asked
  double task_minutes = 5.0;        ///< shards are packed into tasks of about this length
  Index refine_tasks = 0;           ///< beside a refinement's own job, to simulate its rows with it
  Index signal_seconds = 120;       ///< before the time limit: save the work and queue again
  std::string scratch;              ///< folder of the node for shards in the making
  std::string mail;                 ///< address that is told when the study ends or a job fails
  std::vector<std::string> setup;   ///< lines of shell before the work: modules, variables
  std::vector<std::string> sbatch;  ///< further options of all jobs
  StageResources prepare;           ///< targets and proposals
  StageResources simulate;
  StageResources infer;
  StageResources baseline;
  StageResources evaluate;
  StageResources diagnose;
  StageResources policy;  ///< search and tests
  StageResources report;
};

}  // namespace npdr::pipeline
