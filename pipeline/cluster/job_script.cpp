#include "pipeline/cluster/job_script.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/cluster/job_tag.h"
#include "pipeline/plan/shards.h"

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
    const std::string label = label_of(context_.plan, job_);
    if (job_.is_helper()) return "help";
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
    write_mail();
    for (const std::string& line : cluster_.sbatch) text_ += "#SBATCH " + line + "\n";
    for (const std::string& line : resources_.sbatch) text_ += "#SBATCH " + line + "\n";
  }

  // Asks for mail about every failure, and about the end of the last job.
  void write_mail() {
    if (cluster_.mail.empty()) return;
    const bool is_last = stage_of(context_.plan, job_) == Stage::report;
    option("mail-user", cluster_.mail);
    option("mail-type", is_last ? "END,FAIL" : "FAIL");
  }

  void write_description() {
    const std::string array =
        job_.is_array() ? fmt::format(" --array={}", index_ranges(job_.tasks)) : "";
    text_ += fmt::format("# {}\n", label_of(context_.plan, job_));
    text_ += fmt::format(
        "# To submit it by hand, when what it needs is there: sbatch{} THIS_FILE\n\n", array);
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
    const bool has_helpers =
        cluster_.refine_tasks > 0 && std::ranges::any_of(job_.nodes, [&](std::size_t i) {
          return is_refinement(context_.plan, context_.plan.nodes[i]);
        });
    if (has_helpers) {
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

std::filesystem::path log_of_task(const std::filesystem::path& logs, const std::string& stem,
                                  const std::string& id) {
  return logs / fmt::format("{}-{}.log", stem, id);
}

StageResources resources_of(const ClusterConfig& cluster, Stage stage) {
  StageResources resources = cluster.*traits_of(stage).resources;
  if (resources.cpus == 0) resources.cpus = cluster.cpus;
  if (resources.memory.empty()) resources.memory = cluster.memory;
  if (resources.time.empty()) resources.time = cluster.time;
  return resources;
}

}  // namespace npdr::pipeline
