#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/finding.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/cluster/cluster_status.h"
#include "pipeline/process/fitted_text.h"
#include "pipeline/process/progress.h"
#include "pipeline/run/artefact_status.h"

namespace npdr::pipeline {
namespace {

// A row of the table.
struct Standing {
  const Node& node;
  ArtefactStatus status;
  std::optional<NodeJobs> jobs;
  int process = 0;  // of this host, that makes it now

  // Lets what the batch system is doing count more than what it has done so far.
  std::string state() const {
    if (process != 0 || (jobs && !jobs->running.empty())) return "running";
    if (jobs && !jobs->waiting.empty()) return "queued";
    if (jobs && !jobs->failed.empty()) return "failed";
    return name_of(status.state);
  }

  std::string detail() const {
    std::vector<std::string> parts = {status.detail};
    if (process != 0) parts.push_back(fmt::format("process {}", process));
    if (jobs) append(parts, jobs->details());
    std::erase(parts, "");
    return join(parts, "; ");
  }
};

// Tasks that Slurm has; none: nothing was ever submitted to it, or it doesn't answer.
std::optional<std::vector<QueuedTask>> ask_slurm(const Plan& plan) {
  if (read_ledger(plan).empty()) return std::nullopt;
  try {
    return queued_tasks();
  } catch (const Error& error) {
    report_error("npdr status", fmt::format("what is queued isn't known: {}", error.what()));
    return std::nullopt;
  }
}

std::vector<Standing> standings(const Plan& plan, Scrutiny scrutiny) {
  const auto jobs = jobs_of_nodes(plan, ask_slurm(plan));
  const std::vector<int> processes = processes_at_work(plan);
  std::vector<Standing> rows;
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    rows.push_back(
        {plan.nodes[i], status_of(plan, plan.nodes[i], scrutiny), jobs[i], processes[i]});
  }
  return rows;
}

// On a terminal no line wraps in the middle of a word: keys, which '--json' has, too, are left out
// where they have no room, and details go on a line of their own.
void print_table(const std::vector<Standing>& rows) {
  const auto columns = terminal_columns();
  const auto has_room = [&](std::size_t size) {
    return !columns || size <= static_cast<std::size_t>(*columns);
  };
  std::size_t width = 8;
  for (const Standing& row : rows) width = std::max(width, row.node.label().size());
  const auto line = [&](const std::string& label, const std::string& state, const std::string& size,
                        const std::string& seconds, const std::string& key) {
    const std::string text =
        fmt::format("{:<{}}  {:<10}  {:>9}  {:>9}", label, width, state, size, seconds);
    return has_room(text.size() + 10) ? text + "  " + key : text;
  };
  print_line("{}", line("artefact", "state", "size", "seconds", "key"));
  std::map<std::string, int> counts;
  std::uintmax_t bytes = 0;
  double seconds = 0.0;
  for (const Standing& row : rows) {
    const ArtefactStatus& status = row.status;
    ++counts[row.state()];
    bytes += status.bytes;
    const double taken = status.cost.wall_seconds;
    seconds += taken;
    const std::string text =
        line(row.node.label(), row.state(), status.bytes > 0 ? size_text(status.bytes) : "-",
             taken > 0.0 ? fmt::format("{:.2f}", taken) : "-", row.node.key.substr(0, 8));
    const std::string detail = row.detail();
    const bool is_beside = has_room(text.size() + 2 + detail.size());
    print_line("{}{}", text, detail.empty() || !is_beside ? "" : "  " + detail);
    if (!is_beside && !detail.empty()) print_line("    {}", detail);
  }
  std::vector<std::string> summary;
  for (const auto& [state, count] : counts) summary.push_back(fmt::format("{} {}", count, state));
  fmt::print("\n{} artefacts: {}; {}, {:.1f} s of work\n", rows.size(), join(summary),
             size_text(bytes), seconds);
}

struct CostRow {
  std::string name;
  Index artefacts = 0;
  std::uintmax_t bytes = 0;
  Cost cost = {};
};

void add_cost(std::vector<CostRow>& costs, const std::string& name, const ArtefactStatus& status) {
  auto row = std::ranges::find(costs, name, &CostRow::name);
  if (row == costs.end()) row = costs.insert(costs.end(), {.name = name});
  ++row->artefacts;
  row->bytes += status.bytes;
  row->cost += status.cost;
}

void print_costs(const std::string& what, const std::vector<CostRow>& costs) {
  std::size_t width = what.size();
  for (const CostRow& row : costs) width = std::max(width, row.name.size());
  fmt::print("{:<{}}  {:>9}  {:>9}  {:>10}  {:>10}\n", what, width, "artefacts", "size", "seconds",
             "core-hours");
  for (const CostRow& row : costs) {
    fmt::print("{:<{}}  {:>9}  {:>9}  {:>10.2f}  {:>10.4f}\n", row.name, width, row.artefacts,
               size_text(row.bytes), row.cost.wall_seconds, row.cost.core_seconds / 3600.0);
  }
}

// Costs of what is there, by stage and by method; an artefact of several counts for the first.
void print_cost_tables(const Plan& plan) {
  std::vector<CostRow> by_stage, by_method, all;
  for (const Node& node : plan.nodes) {
    const ArtefactStatus status = status_of(plan, node);
    if (!status.is_made) continue;
    const std::string& method = node.uses.front().method;
    add_cost(by_stage, name_of(node.stage), status);
    add_cost(by_method, method.empty() ? "(all methods)" : method, status);
    add_cost(all, "all", status);
  }
  print_costs("stage", by_stage);
  fmt::print("\n");
  print_costs("method", by_method);
  fmt::print("\n");
  print_costs("study", all);
}

nlohmann::ordered_json ids_of(const std::vector<QueuedTask>& tasks) {
  nlohmann::ordered_json ids = nlohmann::ordered_json::array();
  for (const QueuedTask& task : tasks) ids.push_back(task.id());
  return ids;
}

void print_as_json(const std::vector<Standing>& standings) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Standing& row : standings) {
    nlohmann::ordered_json uses = nlohmann::ordered_json::array();
    for (const Use& use : row.node.uses) {
      uses.push_back({{"method", use.method},
                      {"seed", use.seed},
                      {"iteration", use.iteration},
                      {"fold", use.fold},
                      {"round", use.round}});
    }
    rows.push_back({{"stage", name_of(row.node.stage)},
                    {"label", row.node.label()},
                    {"key", row.node.key},
                    {"path", row.node.path.string()},
                    {"state", row.state()},
                    {"detail", row.status.detail},
                    {"bytes", row.status.bytes},
                    {"wall_seconds", row.status.cost.wall_seconds},
                    {"core_seconds", row.status.cost.core_seconds},
                    {"process", row.process},
                    {"uses", uses}});
    if (!row.jobs) continue;
    rows.back()["running"] = ids_of(row.jobs->running);
    rows.back()["queued"] = ids_of(row.jobs->waiting);
    rows.back()["failed"] = row.jobs->failed;
    rows.back()["failed_helpers"] = row.jobs->failed_helpers;
  }
  print_json(rows);
}

// The nodes that a word names: a key, or part of a label; empty: all that aren't up to date.
std::vector<const Node*> named_nodes(const Plan& plan, const std::string& word) {
  std::vector<const Node*> found;
  for (const Node& node : plan.nodes) {
    const bool counts =
        word.empty() ? status_of(plan, node).state != ArtefactState::up_to_date
                     : node.key.starts_with(word) || node.label().find(word) != std::string::npos;
    if (counts) found.push_back(&node);
  }
  if (found.empty() && !word.empty()) {
    throw InputError("no artefact of this study is called '" + word +
                     "'; 'npdr status' lists their names and keys");
  }
  return found;
}

}  // namespace

Action status_command(CLI::App& command) {
  auto study = std::make_shared<StudyArguments>();
  auto json = std::make_shared<bool>(false);
  auto cost = std::make_shared<bool>(false);
  auto check = std::make_shared<bool>(false);
  study->add_to(command);
  auto* as_json = command.add_flag("--json", *json, "for programs");
  auto* as_cost = command.add_flag("--cost", *cost, "what was spent, by stage and by method");
  as_cost->excludes(as_json);
  command
      .add_flag("--check", *check,
                "read every byte of every artefact and shard; status 1: some are damaged")
      ->excludes(as_cost);
  command.footer("Examples:\n  npdr status study.toml\n  npdr status study.toml --cost");
  return [study, json, cost, check] {
    const Plan plan = study->plan_here("npdr status");
    if (*cost) {
      print_cost_tables(plan);
      return ExitStatus::done;
    }
    const auto rows = standings(plan, *check ? Scrutiny::thorough : Scrutiny::quick);
    *json ? print_as_json(rows) : print_table(rows);
    if (!*json) print_verdicts_if_made(plan);
    const bool is_sound =
        std::ranges::all_of(rows, [](const Standing& row) { return row.status.is_sound; });
    return is_sound || !*check ? ExitStatus::done : ExitStatus::failed;
  };
}

Action explain_command(CLI::App& command) {
  auto study = std::make_shared<StudyArguments>();
  auto word = std::make_shared<std::string>();
  study->add_to(command);
  command.add_option("ARTEFACT", *word, "a key, or part of a name that 'npdr status' shows");
  command.footer("Example:\n  npdr explain study.toml evaluate");
  return done_after([study, word] {
    const Plan plan = study->plan_here("npdr explain");
    const auto nodes = named_nodes(plan, *word);
    if (nodes.empty()) fmt::print("all {} artefacts are up to date\n", plan.nodes.size());
    for (const Node* node : nodes) {
      print_line("{} ({}): {}", node->label(), node->key.substr(0, 8),
                 name_of(status_of(plan, *node).state));
      for (const std::string& line : reasons(plan, *node)) print_line("    {}", line);
    }
  });
}

}  // namespace npdr::pipeline
