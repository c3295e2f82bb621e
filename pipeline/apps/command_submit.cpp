#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/cluster/batch_task.h"
#include "pipeline/cluster/cluster_status.h"
#include "pipeline/cluster/submit.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/run/scheduler.h"
#include "pipeline/run/stop_request.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

constexpr Index kUsualArraySize = 1001;  // Slurm's default

struct SubmitArguments {
  StudyArguments study;
  std::string until;
  std::string site;
  std::string mail;
  std::vector<std::string> options;
  bool dry_run = false;
  bool wait = false;
};

// The site's file: named, or where this machine says it is, or where the current folder has one.
ClusterConfig read_site_file(const std::string& named) {
  if (!named.empty()) return read_site(named);
  const char* const of_machine = std::getenv("NPDR_SITE");
  if (of_machine != nullptr && *of_machine != '\0') return read_site(of_machine);
  constexpr const char* usual = "jobs/site.toml";
  return std::filesystem::exists(usual) ? read_site(usual) : ClusterConfig{};
}

std::string summary(const Plan& plan, const std::vector<Job>& jobs) {
  std::size_t num_tasks = 0;
  for (const Job& job : jobs) num_tasks += job.is_array() ? job.tasks.size() : 1;
  return fmt::format("{}: {} jobs of {} tasks", plan.study.name, jobs.size(), num_tasks);
}

void print_jobs(const Plan& plan, const std::vector<Job>& jobs,
                const std::vector<std::string>& ids) {
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::size_t tasks = jobs[i].tasks.size();
    fmt::print("{:>8}  {}{}\n", ids[i], label_of(plan, jobs[i]),
               tasks > 1 ? fmt::format(", {} tasks", tasks) : "");
  }
}

// Until Slurm has nothing more of the study.
ExitStatus wait_for_jobs(const Plan& plan, std::optional<Stage> until) {
  watch_for_stop_requests();
  std::size_t shown = 0;
  for (auto pause = std::chrono::milliseconds(200);;
       pause = std::min(2 * pause, std::chrono::milliseconds(3000))) {
    const std::size_t missing = missing_nodes(plan, until).size();
    if (missing == 0) return ExitStatus::done;
    if (tasks_of(plan, queued_tasks()).empty()) break;
    if (missing != shown) fmt::print(stderr, "{}: {} artefacts to go\n", plan.study.name, missing);
    shown = missing;
    for (auto left = pause; left.count() > 0; left -= std::chrono::milliseconds(100)) {
      if (stop_requested()) return ExitStatus::checkpointed;  // the jobs go on
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
  if (missing_nodes(plan, until).empty()) return ExitStatus::done;
  const auto jobs = jobs_of_nodes(plan, std::vector<QueuedTask>{});
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!jobs[i]) continue;
    for (const std::string& failure : jobs[i]->failed) {
      fmt::print(stderr, "npdr submit: {} failed: {}\n", plan.nodes[i].label(), failure);
    }
  }
  return ExitStatus::failed;
}

ExitStatus submit(SubmitArguments& arguments) {
  Plan plan = arguments.study.plan(read_site_file(arguments.site));
  if (!arguments.mail.empty()) plan.study.cluster.mail = arguments.mail;
  const SubmitConfig config{parse_stage(arguments.until, "--until"), arguments.study.words(),
                            arguments.options};
  const Index given_size = plan.study.cluster.max_array_size;
  if (arguments.dry_run) {
    const auto jobs = missing_jobs(plan, config, {}, given_size > 0 ? given_size : kUsualArraySize);
    fmt::print("{}# {}; Slurm wasn't asked what it has already\n", dry_run_text(plan, config, jobs),
               summary(plan, jobs));
    return ExitStatus::done;
  }
  const std::vector<QueuedTask> queued = tasks_of(plan, queued_tasks());
  const auto jobs =
      missing_jobs(plan, config, queued, given_size > 0 ? given_size : max_array_size());
  if (jobs.empty()) {
    fmt::print(
        "{}: nothing to submit, {}\n", plan.study.name,
        queued.empty() ? "all is up to date" : fmt::format("{} tasks wait or run", queued.size()));
  } else {
    const auto ids = submit_jobs(plan, config, jobs);
    print_jobs(plan, jobs, ids);
    fmt::print("{}; 'npdr status' shows how they stand\n", summary(plan, jobs));
    std::fflush(stdout);
  }
  return arguments.wait ? wait_for_jobs(plan, config.until) : ExitStatus::done;
}

ExitStatus cancel(const StudyArguments& arguments) {
  const Plan plan = arguments.plan();
  std::vector<std::string> ids;
  for (const QueuedTask& task : tasks_of(plan, queued_tasks())) ids.push_back(task.id());
  if (!ids.empty()) cancel_in_slurm(ids);
  fmt::print("{}: {} tasks cancelled; what they have made stays\n", plan.study.name, ids.size());
  return ExitStatus::done;
}

}  // namespace

void add_submit_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand("submit", "bring a study up to date by jobs of Slurm");
  auto arguments = std::make_shared<SubmitArguments>();
  arguments->study.add_to(*command);
  command->add_option("--until", arguments->until, "the last stage to run");
  command->add_option("--site", arguments->site,
                      "file with a table [cluster], for keys that the study leaves out; else that "
                      "of the variable NPDR_SITE, else jobs/site.toml");
  command->add_option("--mail", arguments->mail, "address for mail; replaces cluster.mail");
  command
      ->add_option("--sbatch", arguments->options,
                   "a further option for sbatch, such as --sbatch=--qos=long; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--dry-run", arguments->dry_run, "print the scripts, submit nothing");
  command->add_flag("--wait", arguments->wait, "return when the jobs have ended");
  command->callback([&result, arguments] {
    result = guarded_main("npdr submit", [&] { return submit(*arguments); });
  });
}

void add_cancel_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand("cancel", "end a study's jobs that wait or run");
  auto arguments = std::make_shared<StudyArguments>();
  arguments->add_to(*command);
  command->callback([&result, arguments] {
    result = guarded_main("npdr cancel", [&] { return cancel(*arguments); });
  });
}

void add_task_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand(
      "task", "run a program as the task of a batch job: log, signals, queueing again");
  auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("COMMAND", *words, "program and its arguments, after --")->required();
  command->positionals_at_end();
  command->callback([&result, words] {
    int status = 0;
    result = guarded_main("npdr task", [&] {
      status = run_batch_task(*words);
      return ExitStatus::done;
    });
    if (result == 0) result = status;
  });
}

}  // namespace npdr::pipeline
