#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "core/error.h"
#include "core/printable.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/run/scheduler.h"

namespace npdr::pipeline {
namespace {

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

ExitStatus list_tasks(const TasksArguments& arguments) {
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
  return ExitStatus::done;
}

}  // namespace

Action tasks_command(CLI::App& command) {
  auto arguments = std::make_shared<TasksArguments>();
  arguments->study.add_to(command);
  add_until_option(command, arguments->until, "the last stage to list");
  command.add_option("--shards-per-task", arguments->shards_per_task, "shards of a command")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  command.footer("Example:\n  npdr tasks study.toml --shards-per-task 10");
  return [arguments] { return list_tasks(*arguments); };
}

}  // namespace npdr::pipeline
