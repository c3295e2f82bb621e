#include "pipeline/cluster/submit.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/cluster/job_script.h"
#include "pipeline/cluster/job_tag.h"
#include "pipeline/cluster/ledger.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/shards.h"
#include "pipeline/process/child_process.h"
#include "pipeline/process/utc_time.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

// Core-seconds per row of the first complete shard.
std::optional<double> seconds_so_far(const Plan& plan) {
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::simulate) continue;
    for (const Shard& shard : shards(plan, node)) {
      if (!std::filesystem::exists(shard.path)) continue;
      const Cost cost = provenance_of(open_artefact(shard.path, kSimulationShardSchema)).cost;
      return cost.core_seconds / static_cast<double>(shard.rows.size());
    }
  }
  return std::nullopt;
}

// Rows of a whole batch: a simulator advances so many together.
double time_rows(const Plan& plan) {
  constexpr Index num_rows = 64;
  const auto simulator =
      plan.source->open({.simulator = plan.study.simulator, .target = make_seen_target(plan)});
  const RowMatrix theta = inference::sample_prior(inference::Prior(plan.study.prior), num_rows, 1);
  const auto start = std::chrono::steady_clock::now();
  simulator->simulate(plan.source->parameters().complete(theta), {1, "row_time", 0, 0, 0});
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return cost_of_seconds(elapsed.count()).core_seconds / static_cast<double>(num_rows);
}

// [s] of one core for a row: what complete shards of the study took, else what a few draws of the
// prior take here; 0 of a dataset. None: a program of the user's isn't started for that.
std::optional<double> seconds_per_row(const Plan& plan) {
  if (const auto seconds = seconds_so_far(plan)) return seconds;
  if (!plan.study.source().simulates) return 0.0;
  if (plan.study.source().calls_program) return std::nullopt;
  return time_rows(plan);
}

// How many shards make a task of the length that the study wants.
Index shards_in_task(const Plan& plan, const Node& node, std::optional<double> row_seconds) {
  if (!row_seconds) return 1;
  const auto& cluster = plan.study.cluster;
  const double cores = static_cast<double>(resources_of(cluster, Stage::simulate).cpus);
  const double shard_seconds =
      *row_seconds * static_cast<double>(plan.study.simulate.shard_size) / cores;
  const auto most = static_cast<double>(shards(plan, node).size());
  const double wanted = cluster.task_minutes * 60.0 / std::max(shard_seconds, 1e-9);
  return static_cast<Index>(std::clamp(std::floor(wanted), 1.0, most));
}

std::vector<Index> packing(const Plan& plan) {
  std::vector<Index> packs(plan.nodes.size(), 1);
  std::optional<double> row_seconds;
  bool is_known = false;
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    const Node& node = plan.nodes[i];
    if (node.stage != Stage::simulate || is_complete(plan, node)) continue;
    if (!is_known) row_seconds = seconds_per_row(plan);
    is_known = true;
    packs[i] = shards_in_task(plan, node, row_seconds);
  }
  return packs;
}

ScriptContext context_of(const Plan& plan, const fs::path& folder) {
  return {plan, fs::current_path(), executable_folder(), fs::absolute(folder) / "logs"};
}

std::string array_of(const Plan& plan, const Job& job) {
  if (!job.is_array()) return "";
  const Index limit = plan.study.cluster.array_limit;
  return index_ranges(job.tasks) + (limit > 0 ? fmt::format("%{}", limit) : "");
}

Submission submission_of(const Plan& plan, const Job& job, const fs::path& script,
                         const std::vector<std::string>& options,
                         const std::vector<std::string>& ids) {
  Submission submission{script,  array_of(plan, job), job.after_ok, job.after_any,
                        options, job.helps_queued};
  for (const std::size_t need : job.needs) submission.after_ok.push_back(ids[need]);
  for (const std::size_t helped : job.helps) submission.after.push_back(ids[helped]);
  return submission;
}

fs::path script_of(const Plan& plan, const fs::path& folder, const Job& job) {
  return folder / (file_stem_of(plan, job) + ".sh");
}

// jobs/001, jobs/002, ...
fs::path new_folder(const Plan& plan) {
  make_folder(jobs_folder(plan));
  for (int number = 1;; ++number) {
    const fs::path folder = jobs_folder(plan) / fmt::format("{:03}", number);
    std::error_code error;
    if (fs::create_directory(folder, error)) return folder;
    if (error) throw Error(folder.string() + ": can't be made: " + error.message());
  }
}

}  // namespace

std::vector<Job> missing_jobs(const Plan& plan, std::optional<Stage> until,
                              const std::vector<QueuedTask>& queued, Index max_array_size) {
  return make_jobs({plan, until, in_flight(plan, queued), packing(plan), max_array_size});
}

std::string dry_run_text(const Plan& plan, const std::vector<Job>& jobs,
                         const std::vector<std::string>& options) {
  const fs::path folder = jobs_folder(plan) / "NEW";
  const ScriptContext context = context_of(plan, folder);
  std::string text;
  std::vector<std::string> ids;
  for (const Job& job : jobs) {
    const fs::path script = script_of(plan, folder, job);
    const auto submission = submission_of(plan, job, script, options, ids);
    ids.push_back(fmt::format("JOB_{}", ids.size() + 1));
    text += fmt::format("# {}: {}\n{}\n{}\n", ids.back(), shell_text(sbatch_command(submission)),
                        std::string(72, '-'), job_script(context, job));
    text += std::string(72, '-') + "\n\n";
  }
  return text;
}

void submit_jobs(const Plan& plan, const std::vector<Job>& jobs,
                 const std::vector<std::string>& options,
                 const std::function<void(const Job&, const std::string&)>& on_job) {
  const fs::path folder = fs::absolute(new_folder(plan));
  const ScriptContext context = context_of(plan, folder);
  make_folder(context.logs);
  std::vector<std::string> ids;
  for (const Job& job : jobs) {
    const fs::path script = script_of(plan, folder, job);
    write_text_file(script, job_script(context, job));
    try {
      ids.push_back(submit_to_slurm(submission_of(plan, job, script, options, ids)));
      append_to_ledger(plan, {ids.back(), tag_of(plan, job), job.tasks, script, context.logs,
                              file_stem_of(plan, job), now_utc()});
      on_job(job, ids.back());
    } catch (const Error& error) {
      throw Error(fmt::format(
          "{} of {} jobs are submitted, then {}: {}\n  run 'npdr submit' again for the others",
          ids.size(), jobs.size(), label_of(plan, job), error.what()));
    }
  }
}

}  // namespace npdr::pipeline
