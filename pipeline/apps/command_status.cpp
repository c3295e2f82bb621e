#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/size_text.h"
#include "pipeline/plan/artefact_status.h"

namespace npdr::pipeline {
namespace {

void print_table(const Plan& plan) {
  std::size_t width = 8;
  for (const Node& node : plan.nodes) width = std::max(width, node.label().size());
  fmt::print("{:<{}}  {:<10}  {:>9}  {:>9}  {:<8}  {}\n", "artefact", width, "state", "size",
             "seconds", "key", "");
  std::map<std::string, int> counts;
  std::uintmax_t bytes = 0;
  double seconds = 0.0;
  for (const Node& node : plan.nodes) {
    const ArtefactStatus status = status_of(plan, node);
    ++counts[to_string(status.state)];
    bytes += status.bytes;
    seconds += status.wall_seconds;
    fmt::print("{:<{}}  {:<10}  {:>9}  {:>9}  {}  {}\n", node.label(), width,
               to_string(status.state), status.bytes > 0 ? size_text(status.bytes) : "-",
               status.wall_seconds > 0.0 ? fmt::format("{:.2f}", status.wall_seconds) : "-",
               node.key.substr(0, 8), status.detail);
  }
  std::string summary;
  for (const auto& [state, count] : counts) {
    summary += fmt::format("{}{} {}", summary.empty() ? "" : ", ", count, state);
  }
  fmt::print("\n{} artefacts: {}; {}, {:.1f} s of work\n", plan.nodes.size(), summary,
             size_text(bytes), seconds);
}

struct Cost {
  std::string name;
  Index artefacts = 0;
  std::uintmax_t bytes = 0;
  double seconds = 0.0;
};

void add_cost(std::vector<Cost>& costs, const std::string& name, const ArtefactStatus& status) {
  auto cost =
      std::find_if(costs.begin(), costs.end(), [&](const Cost& c) { return c.name == name; });
  if (cost == costs.end()) cost = costs.insert(costs.end(), {.name = name});
  ++cost->artefacts;
  cost->bytes += status.bytes;
  cost->seconds += status.wall_seconds;
}

void print_costs(const std::string& what, const std::vector<Cost>& costs) {
  std::size_t width = what.size();
  for (const Cost& cost : costs) width = std::max(width, cost.name.size());
  fmt::print("{:<{}}  {:>9}  {:>9}  {:>10}\n", what, width, "artefacts", "size", "seconds");
  for (const Cost& cost : costs) {
    fmt::print("{:<{}}  {:>9}  {:>9}  {:>10.2f}\n", cost.name, width, cost.artefacts,
               size_text(cost.bytes), cost.seconds);
  }
}

// What is there has cost, by stage and by method. What several methods share counts for the first.
void print_cost_tables(const Plan& plan) {
  std::vector<Cost> by_stage, by_method;
  for (const Node& node : plan.nodes) {
    const ArtefactStatus status = status_of(plan, node);
    if (status.state != ArtefactState::up_to_date) continue;
    const std::string& method = node.uses.front().method;
    add_cost(by_stage, to_string(node.stage), status);
    add_cost(by_method, method.empty() ? "(all methods)" : method, status);
  }
  print_costs("stage", by_stage);
  fmt::print("\n");
  print_costs("method", by_method);
}

void print_json(const Plan& plan) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Node& node : plan.nodes) {
    const ArtefactStatus status = status_of(plan, node);
    nlohmann::ordered_json uses = nlohmann::ordered_json::array();
    for (const Use& use : node.uses) {
      uses.push_back({{"method", use.method}, {"seed", use.seed}, {"round", use.round}});
    }
    rows.push_back({{"stage", to_string(node.stage)},
                    {"label", node.label()},
                    {"key", node.key},
                    {"path", node.path.string()},
                    {"state", to_string(status.state)},
                    {"detail", status.detail},
                    {"bytes", status.bytes},
                    {"wall_seconds", status.wall_seconds},
                    {"uses", uses}});
  }
  fmt::print("{}\n", rows.dump(2));
}

// The nodes that a word names: a key, or part of a label; empty: all that aren't up to date.
std::vector<const Node*> named_nodes(const Plan& plan, const std::string& word) {
  std::vector<const Node*> found;
  for (const Node& node : plan.nodes) {
    const bool is_named =
        node.key.starts_with(word) || node.label().find(word) != std::string::npos;
    const bool counts =
        word.empty() ? status_of(plan, node).state != ArtefactState::up_to_date : is_named;
    if (counts) found.push_back(&node);
  }
  if (found.empty() && !word.empty()) {
    throw InputError("no artefact of this study is called '" + word +
                     "'; 'npdr status' lists their names and keys");
  }
  return found;
}

}  // namespace

void add_status_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand("status", "one row per artefact: where it stands");
  auto study = std::make_shared<StudyArguments>();
  auto json = std::make_shared<bool>(false);
  auto cost = std::make_shared<bool>(false);
  study->add_to(*command);
  auto* as_json = command->add_flag("--json", *json, "for programs");
  command->add_flag("--cost", *cost, "what was spent, by stage and by method")->excludes(as_json);
  command->callback([&result, study, json, cost] {
    result = guarded_main("npdr status", [&] {
      const Plan plan = study->plan();
      if (*json) {
        print_json(plan);
      } else {
        *cost ? print_cost_tables(plan) : print_table(plan);
      }
      return ExitStatus::done;
    });
  });
}

void add_explain_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand("explain", "why artefacts aren't up to date");
  auto study = std::make_shared<StudyArguments>();
  auto word = std::make_shared<std::string>();
  study->add_to(*command);
  command->add_option("ARTEFACT", *word, "a key, or part of a name that 'npdr status' shows");
  command->callback([&result, study, word] {
    result = guarded_main("npdr explain", [&] {
      const Plan plan = study->plan();
      const auto nodes = named_nodes(plan, *word);
      if (nodes.empty()) fmt::print("all {} artefacts are up to date\n", plan.nodes.size());
      for (const Node* node : nodes) {
        fmt::print("{} ({}): {}\n", node->label(), node->key.substr(0, 8),
                   to_string(status_of(plan, *node).state));
        for (const std::string& line : reasons(plan, *node)) fmt::print("    {}\n", line);
      }
      return ExitStatus::done;
    });
  });
}

}  // namespace npdr::pipeline
