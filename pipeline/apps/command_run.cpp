#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>

#include "core/parallel.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/child_process.h"
#include "pipeline/process/fitted_text.h"
#include "pipeline/process/progress.h"
#include "pipeline/run/artefact_status.h"
#include "pipeline/run/scheduler.h"

namespace npdr::pipeline {
namespace {

struct RunArguments {
  StudyArguments study;
  std::optional<Stage> until;
  int num_jobs = num_cores();
  std::vector<std::string> artefacts;
  bool dry_run = false;
  bool strict = false;
};

// The study's main tables, as far as there are any, what its checks say, and where the rest is;
// returns whether any check failed. The command that made them all stands below the last one.
bool print_results(const Plan& plan) {
  std::vector<std::filesystem::path> paths;
  for (const char* name : {"parameters.md", "fit.md", "policy.md"}) {
    paths.push_back(plan.work.study(plan.study.name) / "tables" / name);
    if (!std::filesystem::exists(paths.back())) paths.pop_back();
  }
  const auto columns = terminal_columns();
  for (const std::filesystem::path& path : paths) {
    std::ifstream table(path);
    std::string text(std::istreambuf_iterator<char>(table), {});
    const std::size_t end = text.rfind("\nMade by:\n");
    if (path != paths.back() && end != std::string::npos) text.erase(end + 1);
    std::cout << (columns ? fitted_tables(text, *columns, path) : text) << std::flush;
  }
  return print_verdicts(plan);
}

// Both make all of it, with the same bits.
void warn_of_another_run(const Plan& plan, const std::vector<const Node*>& missing) {
  const std::vector<int> processes = processes_at_work(plan);
  for (const Node* node : missing) {
    const int process = processes[static_cast<std::size_t>(node - plan.nodes.data())];
    if (process == 0) continue;
    report_warning("npdr run",
                   fmt::format("process {} makes {} already, and this run does that work "
                               "once more: stop one of both",
                               process, node->label()));
    return;
  }
}

// What --only and --seeds left out, the report lacks.
void print_selection(StudyArguments study) {
  std::vector<std::string> options;
  if (!study.methods.empty()) options.emplace_back("--only");
  if (!study.seeds.empty()) options.emplace_back("--seeds");
  if (options.empty()) return;
  study.methods.clear();
  study.seeds.clear();
  print_line("report and tables hold what {} chose; all again: npdr run {}", join(options, " and "),
             shell_text(study.words()));
}

// Where nothing is made, nothing reads what was damaged after it was made.
void require_sound(const Plan& plan) {
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::report || !is_complete(plan, node)) continue;
    const ArtefactStatus status = status_of(plan, node);
    if (!status.is_sound) throw InputError(node.label() + ": " + status.detail);
  }
}

ExitStatus run(const RunArguments& arguments) {
  stop_with_parent();
  const Plan plan = arguments.study.plan_here("npdr run");
  SchedulerConfig config{arguments.num_jobs, arguments.until, {}};
  for (const std::string& key : arguments.artefacts) {
    config.artefacts.push_back(plan.node_by_key(key).key);
  }
  if (arguments.dry_run) {
    for (const Node* node : missing_nodes(plan, config)) {
      fmt::print("# {}\n{}\n", node->label(), shell_text(stage_command(plan, *node)));
    }
    return ExitStatus::done;
  }
  print_warnings("npdr run", plan);
  const std::vector<const Node*> missing = missing_nodes(plan, config);
  warn_of_another_run(plan, missing);
  if (missing.empty()) {
    require_sound(plan);
    fmt::print(stderr, "{}: nothing to do, all is up to date\n", plan.study.name);
  }
  const ExitStatus status = Scheduler(plan, config).run();
  const Node& report = plan.nodes.back();
  const bool is_whole = !config.until && config.artefacts.empty();
  const bool makes_report = std::ranges::count(config.artefacts, report.key) > 0;
  if (status != ExitStatus::done || !(is_whole || makes_report)) return status;
  const bool any_failed = print_results(plan);
  print_selection(arguments.study);
  return any_failed && arguments.strict ? ExitStatus::failed_checks : status;
}

}  // namespace

Action run_command(CLI::App& command) {
  auto arguments = std::make_shared<RunArguments>();
  arguments->study.add_to(command);
  add_until_option(command, arguments->until, "the last stage to run");
  command.add_option("-j,--jobs", arguments->num_jobs, "cores to use")
      ->capture_default_str()
      ->check(CLI::Range(1, 4096));
  command
      .add_option("--artefact", arguments->artefacts,
                  "only the artefact whose key begins like this; may be repeated")
      ->allow_extra_args(false);
  command.add_flag("--dry-run", arguments->dry_run, "print the commands that are missing");
  command.add_flag("--strict", arguments->strict, "exit status 4 when a check fails");
  command.footer(
      "Examples:\n  npdr run study.toml\n  npdr run study.toml --seeds 1 --set "
      "evaluate.num_samples=100");
  return [arguments] { return run(*arguments); };
}

}  // namespace npdr::pipeline
