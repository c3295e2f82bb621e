// The front door: `npdr <command>`. Called by the name of a stage's executable, such as
// `npdr-simulate`, which is a link to this program, it is that stage.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/stop_request.h"
#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/child_process.h"
#include "pipeline/run/run_stage.h"

namespace npdr::pipeline {
namespace {

struct StageArguments {
  StudyArguments study;
  std::optional<Index> round;
  std::string shards;
  std::string key;
  std::string helper;
};

// Takes a node that belongs to no round as one of each.
bool uses_round(const Node& node, std::optional<Index> round) {
  return !round || std::ranges::any_of(node.uses, [&](const Use& use) {
    return use.round == *round || use.round == 0;
  });
}

void check_round(const Plan& plan, std::optional<Index> round) {
  Index last = 0;
  for (const Node& node : plan.nodes) {
    for (const Use& use : node.uses) last = std::max(last, use.round);
  }
  if (!round || (*round >= 1 && *round <= last)) return;
  throw InputError(fmt::format("--round {}: the methods have rounds 1 to {}", *round, last));
}

// Those of the given numbers that the simulation has.
std::vector<Index> its_shards(const Plan& plan, const Node& node, const std::vector<Index>& given) {
  if (given.empty()) return {};  // nodes of other stages have no shards
  std::vector<Index> numbers = given;
  const Index count = num_shards(plan, node);
  std::erase_if(numbers, [&](Index number) { return number >= count; });
  return numbers;
}

// Artefacts of the program's stages in their order, of which simulations have one of the shards or
// are complete. Throws InputError where none has one, and some aren't complete.
std::vector<const Node*> asked_nodes(const Plan& plan, const std::string& program,
                                     std::optional<Index> round, const std::vector<Index>& shards) {
  std::vector<const Node*> nodes;
  const Node* smaller = nullptr;
  bool any_has_shards = false;
  for (const StageTraits& stage : enum_table(Stage{})) {
    if (stage.program != program) continue;
    for (const Node& node : plan.nodes) {
      if (node.stage != stage.value || !uses_round(node, round)) continue;
      const bool has_shards = shards.empty() || !its_shards(plan, node, shards).empty();
      any_has_shards = any_has_shards || has_shards;
      if (has_shards || is_complete(plan, node)) {
        nodes.push_back(&node);
      } else if (smaller == nullptr) {
        smaller = &node;
      }
    }
  }
  if (!any_has_shards && smaller != nullptr) require_shard(plan, *smaller, shards.front());
  return nodes;
}

// Without a round, later rounds wait for the stages in between: only what is ready is run. When
// nothing was, the first missing input is the error.
void run_missing(const Plan& plan, const std::string& program, const StageArguments& arguments,
                 const std::vector<Index>& shards) {
  const Node* first_waiting = nullptr;
  bool any_run = false;
  for (const Node* node : asked_nodes(plan, program, arguments.round, shards)) {
    if (is_complete(plan, *node)) {
      settle(plan, *node);
    } else if (has_inputs(plan, *node)) {
      run_stage(plan, *node, its_shards(plan, *node, shards));
      any_run = true;
      fmt::print("{}: {}\n", node->label(),
                 is_complete(plan, *node) ? node->path.string() : "shards done");
      stop_here_if_requested();
    } else if (first_waiting == nullptr) {
      first_waiting = node;
    }
  }
  if (any_run) return;
  if (first_waiting != nullptr) require_inputs(plan, *first_waiting);
  fmt::print("{}: nothing to do, all is up to date\n", program);
}

// "2/8": the second of eight.
Helper parse_helper(const std::string& text) {
  const std::vector<std::string> parts = split(text, '/');
  const auto number = parts.size() == 2 ? parse_count(parts[0]) : std::nullopt,
             count = parts.size() == 2 ? parse_count(parts[1]) : std::nullopt;
  if (number && count && *number >= 1 && *number <= *count && *count <= kMostHelpers) {
    return {.number = *number, .count = *count};
  }
  throw InputError(fmt::format("--helper {}: must be I/N with 1 <= I <= N <= {}, such as 1/4",
                               quoted(text), kMostHelpers));
}

void help(const Plan& plan, const StageArguments& arguments) {
  const Helper helper = parse_helper(arguments.helper);
  if (arguments.key.empty() || !arguments.shards.empty() || arguments.round) {
    throw InputError(
        "--helper: must come with --artefact KEY of a posterior of the algorithm 'refine', and "
        "without --shard and --round; 'npdr run STUDY --dry-run' lists all keys");
  }
  const Node& node = plan.node_by_key(arguments.key);
  const Index num_rows = run_helper(plan, node, helper);
  fmt::print("{}: helped with {}\n", node.label(), counted(num_rows, "row"));
}

// Stages whose executable has that name (plan/stage.h).
std::vector<std::string> stages_of(const std::string& program) {
  std::vector<std::string> stages;
  for (const StageTraits& stage : enum_table(Stage{})) {
    if (stage.program == program) stages.emplace_back(stage.name);
  }
  return stages;
}

// Makes the missing artefacts of the stages whose executable is `program`, where their inputs are
// there. Returns the exit status.
int stage_main(const std::string& program, int argc, char** argv) {
  CLI::App app("Makes what a study lacks of the stage " + join(stages_of(program), " or ") + ".",
               program);
  StageArguments arguments;
  arguments.study.add_to(app);
  app.add_option("--round", arguments.round, "only this round, counted from 1");
  app.add_option("--artefact", arguments.key, "only the artefact whose key begins like this");
  if (program == traits_of(Stage::simulate).program) {
    app.add_option("--shard", arguments.shards, "only these shards, such as 0-3,7");
    app.add_option("--helper", arguments.helper,
                   "simulate rows for the refinement --artefact while it runs elsewhere, as the "
                   "I-th of N helpers: I/N, such as 1/4");
  }
  int status = 0;
  if (!parse_command_line(app, argc, argv, status)) return status;
  stop_with_parent();
  return guarded_main(program, [&] {
    const Plan plan = arguments.study.plan();
    check_round(plan, arguments.round);
    if (!arguments.helper.empty()) {
      help(plan, arguments);
      return ExitStatus::done;
    }
    const std::vector<Index> shard_numbers =
        arguments.shards.empty() ? std::vector<Index>{} : parse_ranges(arguments.shards);
    if (arguments.key.empty()) {
      run_missing(plan, program, arguments, shard_numbers);
    } else {
      run_stage(plan, plan.node_by_key(arguments.key), shard_numbers);
    }
    return ExitStatus::done;
  });
}

int npdr_main(int argc, char** argv) {
  CLI::App app(
      "npdr finds which physics parameters explain recorded motion, as a Bayesian posterior.",
      "npdr");
  app.require_subcommand(1);
  app.fallthrough(false);
  int result = 0;
  for (const Command& command : kCommands) add_command(app, command, result);
  app.footer("Examples:\n  npdr new study\n  npdr run study.toml\n  npdr help run");
  if (argc > 1 && argv[1] == std::string_view(kCompleteCommand)) {
    return guarded_main("npdr", [&] {
      fmt::print("{}", completions(app, {argv + 2, argv + argc}));
      return ExitStatus::done;
    });
  }
  int status = 0;
  return parse_command_line(app, argc, argv, status) ? result : status;
}

}  // namespace
}  // namespace npdr::pipeline

int main(int argc, char** argv) {
  const std::string name = std::filesystem::path(argc > 0 ? argv[0] : "").filename();
  return npdr::pipeline::stages_of(name).empty() ? npdr::pipeline::npdr_main(argc, argv)
                                                 : npdr::pipeline::stage_main(name, argc, argv);
}
