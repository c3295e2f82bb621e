#include "pipeline/cluster/submit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/cluster/cluster_status.h"
#include "pipeline/cluster/job_tag.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/build_info.h"
#include "pipeline/process/child_process.h"

namespace npdr::pipeline {
namespace {

// A value as sbatch reads it from a script, where blanks, quotes and # end it.
std::string quoted_value(const std::string& value) {
  if (value.find_first_of(" \t'\"#") == std::string::npos) return value;
  return "\"" + replaced_all(value, "\"", "\\\"") + "\"";
}

class ScriptWriter {
 public:
  ScriptWriter(const ScriptContext& context, const Job& job)
      : context_(context),
        job_(job),
        cluster_(context.plan.study.cluster),
        resources_(resources_of(cluster_, stage_of(context.plan, job))) {}

  std::string write() {
    check_paths();
    text_ = "#!/bin/bash\n";
    write_options();
    write_description();
    write_setup();
    job_.is_array() ? write_array() : write_job();
    return text_;
  }

 private:
  // A backslash also keeps sbatch from seeing the patterns in the name of a log.
  void check_paths() const {
    for (const std::filesystem::path& path : {context_.folder, context_.logs}) {
      if (path.string().find_first_of("\\\n") == std::string::npos) continue;
      throw InputError(path.string() +
                       ": Slurm can't be given a path with a backslash or a line break; choose "
                       "another --work or current folder");
    }
  }

  void option(const std::string& name, const std::string& value) {
    if (!value.empty()) text_ += fmt::format("#SBATCH --{}={}\n", name, quoted_value(value));
  }

  std::string kind() const {
    if (job_.is_helper()) return "help";
    const std::string label = label_of(context_.plan, job_);
    return label == kPrepareLabel ? label : name_of(stage_of(context_.plan, job_));
  }

  void write_options() {
    const std::string id = job_.is_array() ? "%A_%a" : "%j";
    // sbatch replaces %A and the like in a path.
    const std::string logs = replaced_all(context_.logs.string(), "%", "%%");
    option("job-name", fmt::format("npdr-{}-{}", folder_slug(context_.plan.study.name), kind()));
    option("comment", tag_of(context_.plan, job_).text());
    option("chdir", context_.folder);
    option("output", fmt::format("{}/{}-{}.log", logs, file_stem_of(context_.plan, job_), id));
    option("partition", cluster_.partition);
    option("account", cluster_.account);
    option("ntasks", "1");
    option("cpus-per-task", std::to_string(resources_.cpus));
    option("mem", resources_.memory);
    option("time", resources_.time);
    option("signal", fmt::format("B:USR1@{}", cluster_.signal_seconds));
    option("kill-on-invalid-dep", "yes");
    option("open-mode", "append");
    text_ += "#SBATCH --requeue\n";
    if (!cluster_.mail.empty()) {  // about every failure, and about the end of the last job
      const bool is_last = stage_of(context_.plan, job_) == Stage::report;
      option("mail-user", cluster_.mail);
      option("mail-type", is_last ? "END,FAIL" : "FAIL");
    }
    for (const std::string& line : cluster_.sbatch) text_ += "#SBATCH " + line + "\n";
    for (const std::string& line : resources_.sbatch) text_ += "#SBATCH " + line + "\n";
  }

  void write_description() {
    text_ += fmt::format(
        "# {}\n# To submit it by hand, when what it needs is there: sbatch{} THIS_FILE\n\n",
        label_of(context_.plan, job_),
        job_.is_array() ? " --array=" + index_ranges(job_.tasks) : "");
  }

  void write_setup() {
    for (const std::string& line : cluster_.setup) text_ += line + "\n";
    text_ += "export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}\n";
    // As it stands: variables of the node, such as $TMPDIR, are the point of it.
    if (!cluster_.scratch.empty()) {
      text_ += fmt::format("export NPDR_SCRATCH=\"{}\"\n", cluster_.scratch);
    }
    text_ += "\n";
  }

  std::string program(const std::string& name) const {
    return shell_word(context_.programs / name);
  }

  void write_array() {
    const Node& node = context_.plan.nodes[job_.nodes.front()];
    std::string part =
        fmt::format("--helper \"$((SLURM_ARRAY_TASK_ID + 1))/{}\"", job_.tasks.size());
    if (!job_.is_helper()) {
      const Index last = num_shards(context_.plan, node) - 1;
      const std::string task = job_.first_task == 0
                                   ? "SLURM_ARRAY_TASK_ID"
                                   : fmt::format("(SLURM_ARRAY_TASK_ID + {})", job_.first_task);
      text_ += fmt::format("first=$(({} * {}))\n", task, job_.shards_per_task);
      text_ += fmt::format("last=$((first + {0} < {1} ? first + {0} : {1}))\n",
                           job_.shards_per_task - 1, last);
      part = "--shard \"$first-$last\"";
    }
    text_ += fmt::format("exec {} task -- {} {} --artefact {} {}\n", program("npdr"),
                         program("npdr-simulate"), shell_text(context_.plan.words), node.key, part);
  }

  void write_job() {
    text_ += fmt::format("exec {0} task -- {0} run {1}", program("npdr"),
                         shell_text(context_.plan.words));
    for (const std::size_t i : job_.nodes) {
      text_ += fmt::format(" \\\n  --artefact {}", context_.plan.nodes[i].key);
    }
    // The site's file, which may say it, is known here alone.
    const auto is_refined = [&](std::size_t i) {
      return is_refinement(context_.plan, context_.plan.nodes[i]);
    };
    if (cluster_.refine_tasks > 0 && std::ranges::any_of(job_.nodes, is_refined)) {
      text_ += fmt::format(" \\\n  --set cluster.refine_tasks={}", cluster_.refine_tasks);
    }
    text_ += " \\\n  --jobs \"$OMP_NUM_THREADS\"\n";
  }

  const ScriptContext& context_;
  const Job& job_;
  const ClusterConfig& cluster_;
  StageResources resources_;
  std::string text_;
};

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
  const auto start = Clock::now();
  simulator->simulate(plan.source->parameters().complete(theta), {1, "row_time", 0, 0, 0});
  return cost_of_seconds(seconds_since(start)).core_seconds / static_cast<double>(num_rows);
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
  std::optional<std::optional<double>> row_seconds;  // once they are asked for
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    const Node& node = plan.nodes[i];
    if (node.stage != Stage::simulate || is_complete(plan, node)) continue;
    if (!row_seconds) row_seconds.emplace(seconds_per_row(plan));
    packs[i] = shards_in_task(plan, node, *row_seconds);
  }
  return packs;
}

ScriptContext context_of(const Plan& plan, const fs::path& folder) {
  return {plan, fs::current_path(), executable_folder(), fs::absolute(folder) / "logs"};
}

Submission submission_of(const Plan& plan, const Job& job, const fs::path& script,
                         const std::vector<std::string>& options,
                         const std::vector<std::string>& ids) {
  Submission submission{script, "", job.after_ok, job.after_any, options, job.helps_queued};
  const Index limit = plan.study.cluster.array_limit;
  if (job.is_array()) submission.array = index_ranges(job.tasks);
  if (job.is_array() && limit > 0) submission.array += fmt::format("%{}", limit);
  for (const std::size_t need : job.needs) submission.after_ok.push_back(ids[need]);
  for (const std::size_t helped : job.helps) submission.after.push_back(ids[helped]);
  return submission;
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

std::string job_script(const ScriptContext& context, const Job& job) {
  return ScriptWriter(context, job).write();
}

std::string file_stem_of(const Plan& plan, const Job& job) {
  std::string stem = folder_slug(label_of(plan, job));
  // A study of many seeds has several such jobs.
  if (stem == kPrepareLabel) {
    stem = fmt::format("{}-{}", kPrepareLabel, plan.nodes[job.nodes.front()].key.substr(0, 8));
  }
  if (job.first_task > 0) stem = fmt::format("{}-from-{}", stem, job.first_task);
  return stem;
}

StageResources resources_of(const ClusterConfig& cluster, Stage stage) {
  StageResources resources = cluster.*traits_of(stage).resources;
  if (resources.cpus == 0) resources.cpus = cluster.cpus;
  if (resources.memory.empty()) resources.memory = cluster.memory;
  if (resources.time.empty()) resources.time = cluster.time;
  return resources;
}

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
    const fs::path script = folder / (file_stem_of(plan, job) + ".sh");
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
    const fs::path script = folder / (file_stem_of(plan, job) + ".sh");
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
