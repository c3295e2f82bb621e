// Commands for batch systems: submit, cancel, task, tasks.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include "core/error.h"
#include "core/printable.h"
#include "core/shell_text.h"
#include "core/stop_request.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/cluster/batch_task.h"
#include "pipeline/cluster/cluster_status.h"
#include "pipeline/cluster/job_tag.h"
#include "pipeline/cluster/submit.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/progress.h"
#include "pipeline/run/artefact_status.h"
#include "pipeline/run/scheduler.h"

namespace npdr::pipeline {
namespace {

constexpr Index kUsualArraySize = 1001;  // Slurm's default

struct SubmitArguments {
  StudyArguments study;
  std::optional<Stage> until;
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
  if (!std::filesystem::exists(usual)) return {};
  fmt::print(stderr,
             "site: {} of the current folder, with its lines of shell (--site names another)\n",
             usual);
  return read_site(usual);
}

template <class T>
void require(const std::string& option, const std::string& found, const T& value,
             const Constraint<T>& allowed) {
  if (!satisfies(value, allowed)) throw InputError(must_be(option, quoted(found), allowed.words));
}

std::string summary(const Plan& plan, const std::vector<Job>& jobs) {
  std::size_t num_tasks = 0;
  for (const Job& job : jobs) num_tasks += job.is_array() ? job.tasks.size() : 1;
  return fmt::format("{}: {} jobs of {} tasks", plan.study.name, jobs.size(), num_tasks);
}

// Whether Slurm has anything that makes something of the study: helpers alone don't. It may be away
// for a while: its controller restarts.
bool is_busy(const Plan& plan) {
  try {
    return std::ranges::any_of(in_flight(plan, queued_tasks()), &InFlight::is_made);
  } catch (const Error& error) {
    report_error("npdr submit", fmt::format("going on to wait: {}", error.what()));
    return true;
  }
}

// False: a stop was requested.
bool pause(std::chrono::milliseconds length) {
  constexpr std::chrono::milliseconds step(100);
  for (auto left = length; left.count() > 0 && !stop_requested(); left -= step) {
    std::this_thread::sleep_for(step);
  }
  return !stop_requested();
}

void print_failures(const Plan& plan, std::optional<Stage> until) {
  const auto jobs = jobs_of_nodes(plan, std::vector<QueuedTask>{});
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const Node& node = plan.nodes[i];
    std::vector<std::string> failures;
    if (jobs[i]) failures = jobs[i]->failed;
    if (node.stage == Stage::simulate && is_complete(plan, node)) {
      const ArtefactStatus status = status_of(plan, node);
      if (status.state == ArtefactState::failed) failures.push_back(status.detail);
    }
    for (const std::string& failure : failures) {
      report_error("npdr submit", fmt::format("{} failed: {}", node.label(), failure));
    }
  }
  const auto missing = missing_nodes(plan, until);
  if (missing.empty()) return;
  report_error("npdr submit",
               fmt::format("{} artefacts are missing, the first one {}; submit again",
                           missing.size(), missing.front()->label()));
}

// Until Slurm has nothing more of the study; less and less often.
ExitStatus wait_for_jobs(const Plan& plan, std::optional<Stage> until) {
  using std::chrono::milliseconds;
  constexpr milliseconds longest(30'000);
  watch_for_stop_requests();
  std::size_t shown = 0;
  for (milliseconds length(200);; length = std::min(length * 5 / 4, longest)) {
    const bool busy = is_busy(plan);
    const std::size_t missing = missing_nodes(plan, until).size();
    if (missing == 0) return ExitStatus::done;
    if (!busy) break;
    if (missing != shown) fmt::print(stderr, "{}: {} artefacts to go\n", plan.study.name, missing);
    shown = missing;
    if (!pause(length)) return ExitStatus::checkpointed;  // the jobs go on
  }
  print_failures(plan, until);
  return ExitStatus::failed;
}

// Tasks that the study has in the queue. Cancels those that wait for what will never come.
std::vector<QueuedTask> sound_tasks(const Plan& plan) {
  const std::vector<QueuedTask> queued = tasks_of(plan, queued_tasks());
  const std::vector<std::string> doomed = doomed_jobs(plan, queued);
  if (doomed.empty()) return queued;
  cancel_in_slurm(doomed);
  fmt::print("{}: {} jobs that waited in vain are submitted anew\n", plan.study.name,
             doomed.size());
  return without_jobs(queued, doomed);
}

// Tasks in Slurm that make anything of the study as it is now, or as it was when they were
// submitted.
std::vector<QueuedTask> submitted_tasks(const Plan& plan) {
  std::set<std::pair<std::string, std::string>> known;
  for (const LedgerEntry& entry : read_ledger(plan)) known.emplace(entry.job, entry.tag.text());
  std::vector<QueuedTask> tasks = queued_tasks();
  for (const QueuedTask& task : tasks_of(plan, tasks)) known.emplace(task.job, task.comment);
  std::erase_if(tasks, [&](const QueuedTask& task) {
    return !known.contains({task.job, task.comment});
  });
  return tasks;
}

void submit_missing(const Plan& plan, const SubmitArguments& arguments) {
  const SubmissionLock lock(plan);
  const std::vector<QueuedTask> queued = sound_tasks(plan);
  const Index given_size = plan.study.cluster.max_array_size;
  const auto jobs =
      missing_jobs(plan, arguments.until, queued, given_size > 0 ? given_size : max_array_size());
  if (jobs.empty()) {
    return fmt::print(
        "{}: nothing to submit, {}\n", plan.study.name,
        queued.empty() ? "all is up to date" : fmt::format("{} tasks wait or run", queued.size()));
  }
  submit_jobs(plan, jobs, arguments.options, [&](const Job& job, const std::string& id) {
    const std::size_t tasks = job.tasks.size();
    fmt::print("{:>8}  {}{}\n", id, label_of(plan, job),
               tasks > 1 ? fmt::format(", {} tasks", tasks) : "");
    std::fflush(stdout);
  });
  fmt::print("{}; 'npdr status' shows how they stand\n", summary(plan, jobs));
  std::fflush(stdout);
}

ExitStatus submit(SubmitArguments& arguments) {
  Plan plan = arguments.study.plan(read_site_file(arguments.site));
  if (!arguments.mail.empty()) plan.study.cluster.mail = arguments.mail;
  require("--mail", arguments.mail, arguments.mail, option_value());
  for (const std::string& option : arguments.options) {
    require("--sbatch", option, std::vector{option}, options_constraint());
  }
  if (arguments.dry_run) {
    const Index given_size = plan.study.cluster.max_array_size;
    const auto jobs =
        missing_jobs(plan, arguments.until, {}, given_size > 0 ? given_size : kUsualArraySize);
    fmt::print("{}# {}; Slurm wasn't asked what it has already\n",
               dry_run_text(plan, jobs, arguments.options), summary(plan, jobs));
    return ExitStatus::done;
  }
  print_warnings("npdr submit", plan);
  submit_missing(plan, arguments);
  const ExitStatus status =
      arguments.wait ? wait_for_jobs(plan, arguments.until) : ExitStatus::done;
  if (status == ExitStatus::done) print_verdicts_if_made(plan);
  return status;
}

void cancel(const StudyArguments& arguments) {
  const Plan plan = arguments.plan();
  const std::vector<QueuedTask> tasks = submitted_tasks(plan);
  std::set<std::string> jobs;
  for (const QueuedTask& task : tasks) jobs.insert(task.job);
  if (!jobs.empty()) cancel_in_slurm({jobs.begin(), jobs.end()});
  fmt::print("{}: {} tasks canceled; what they have made stays\n", plan.study.name, tasks.size());
}

struct TasksArguments {
  StudyArguments study;
  std::optional<Stage> until;
  Index shards_per_task = 1;
};

void print_task(const std::vector<std::string>& command, const std::string& shards) {
  std::vector<std::string> words = {executable_folder() / "npdr", "task", "--"};
  append(words, command);
  if (!shards.empty()) words.insert(words.end(), {"--shard", shards});
  const std::string line = shell_text(words);
  if (line.find_first_of("\r\n") != std::string::npos) {
    throw InputError(printable_line(line) +
                     ": has a line break, and a command is a line of this list; choose another "
                     "name of the study's file or of --work");
  }
  fmt::print("{}\n", line);
}

// Neighbors of a simulation's missing shards share a task.
void print_shards(const Plan& plan, const Node& node, const std::vector<std::string>& command,
                  Index shards_per_task) {
  const std::vector<Index> missing = missing_shards(plan, node);
  if (missing.empty()) print_task(command, "");  // only to be joined
  const auto step = static_cast<std::size_t>(shards_per_task);
  for (std::size_t i = 0; i < missing.size(); i += step) {
    const std::size_t end = std::min(i + step, missing.size());
    print_task(command, index_ranges({missing.begin() + static_cast<std::ptrdiff_t>(i),
                                      missing.begin() + static_cast<std::ptrdiff_t>(end)}));
  }
}

// After the refinement's own command: where there is no room for all, helpers that come too late
// find it complete.
void print_helpers(const Plan& plan, const Node& node) {
  const Index count = is_refinement(plan, node) ? plan.study.cluster.refine_tasks : 0;
  for (Index number = 1; number <= count; ++number) {
    print_task(helper_command(plan, node, {number, count}), "");
  }
}

void list_tasks(const TasksArguments& arguments) {
  const Plan plan = arguments.study.plan();
  for (const Node* node : missing_nodes(plan, arguments.until)) {
    if (!has_inputs(plan, *node)) continue;
    const std::vector<std::string> command = stage_command(plan, *node);
    if (node->stage == Stage::simulate) {
      print_shards(plan, *node, command, arguments.shards_per_task);
    } else {
      print_task(command, "");
      print_helpers(plan, *node);
    }
  }
}

}  // namespace

Action submit_command(CLI::App& command) {
  auto arguments = std::make_shared<SubmitArguments>();
  arguments->study.add_to(command);
  add_until_option(command, arguments->until, "the last stage to run");
  command.add_option("--site", arguments->site,
                     "file with a table [cluster], for keys that the study leaves out; else that "
                     "of the variable NPDR_SITE, else jobs/site.toml");
  command.add_option("--mail", arguments->mail, "address for mail; replaces cluster.mail");
  command
      .add_option("--sbatch", arguments->options,
                  "a further option for sbatch, such as --sbatch=--qos=long; may be repeated")
      ->allow_extra_args(false);
  command.add_flag("--dry-run", arguments->dry_run, "print the scripts, submit nothing");
  command.add_flag("--wait", arguments->wait, "return when the jobs have ended");
  command.footer("Example:\n  npdr submit study.toml --dry-run");
  return [arguments] { return submit(*arguments); };
}

Action cancel_command(CLI::App& command) {
  auto arguments = std::make_shared<StudyArguments>();
  arguments->add_to(command);
  command.footer("Example:\n  npdr cancel study.toml");
  return done_after([arguments] { cancel(*arguments); });
}

Action task_command(CLI::App& command) {
  auto words = std::make_shared<std::vector<std::string>>();
  command.add_option("COMMAND", *words, "program and its arguments, after --")->required();
  command.positionals_at_end();
  command.footer("Example:\n  npdr task -- npdr-simulate study.toml --shard 0");
  return [words] { return static_cast<ExitStatus>(run_batch_task(*words)); };
}

Action tasks_command(CLI::App& command) {
  auto arguments = std::make_shared<TasksArguments>();
  arguments->study.add_to(command);
  add_until_option(command, arguments->until, "the last stage to list");
  command.add_option("--shards-per-task", arguments->shards_per_task, "shards of a command")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  command.footer("Example:\n  npdr tasks study.toml --shards-per-task 10");
  return done_after([arguments] { list_tasks(*arguments); });
}

}  // namespace npdr::pipeline
