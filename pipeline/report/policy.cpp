#include "pipeline/report/policy.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "pipeline/plan/completeness.h"
#include "pipeline/predictions/closed_loop.h"
#include "pipeline/report/policy_figures.h"

namespace npdr::pipeline {
namespace {

using analysis::Cell;
using analysis::Row;
using analysis::Summary;
using analysis::Table;

// Tests of a method in the order of seeds: before any search, or after the last.
std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        bool is_before) {
  std::vector<const PolicyTest*> tests;
  for (const PolicyTestRun& run : data.policy_tests) {
    if (run.use.method == method && (run.use.iteration == 0) == is_before) {
      tests.push_back(&run.test);
    }
  }
  return tests;
}

using Outcome = RowMatrix PolicyOutcomes::*;
using Place = std::optional<PolicyOutcomes> PolicyTest::*;

// All rollouts of all seeds.
Vector pooled(const std::vector<const PolicyTest*>& tests, Place place, Outcome outcome) {
  Vector all;
  for (const PolicyTest* test : tests) {
    const PolicyOutcomes& outcomes = *(test->*place);
    const RowMatrix& values = outcomes.*outcome;
    all.conservativeResize(all.size() + values.size());
    all.tail(values.size()) = values.reshaped<Eigen::RowMajor>();
  }
  return all;
}

Vector seed_means(const std::vector<const PolicyTest*>& tests, Place place, Outcome outcome) {
  Vector means(static_cast<Index>(tests.size()));
  for (Index i = 0; i < means.size(); ++i) {
    means(i) =
        analysis::summarize(pooled({tests[static_cast<std::size_t>(i)]}, place, outcome)).mean;
  }
  return means;
}

bool has_target(const ReportData& data) { return data.plan.study.target.truth.has_value(); }
bool has_grid(const ReportData& data) { return data.plan.study.policy.grid.is_used(); }

void add_columns(Table& table, const std::vector<std::string>& titles) {
  for (const std::string& title : titles) table.columns.push_back({title, false});
}

// Counts of one experiment: of the target domain, of inference, of the search.
Index num_target_rollouts(const ReportData& data, const MethodConfig& method) {
  if (!infers(method)) return 0;
  const Study& study = data.plan.study;
  const Index all = study.target.recording ? data.plan.target.num_rollouts() - study.target.held_out
                                           : study.target.num_rollouts;
  return (method.num_rollouts > 0 ? method.num_rollouts : all) * study.num_iterations_of(method);
}

bool is_used_by(const Node& node, const std::string& method, std::uint64_t seed) {
  return std::ranges::any_of(
      node.uses, [&](const Use& use) { return use.method == method && use.seed == seed; });
}

Index num_simulations(const ReportData& data, const std::string& method) {
  Index count = 0;
  for (const Node& node : data.plan.nodes) {
    if (node.stage != Stage::simulate || is_calibration(node)) continue;
    if (is_used_by(node, method, data.seeds.front())) count += num_rows(data.plan, node);
  }
  return count;
}

Vector num_policy_rollouts(const ReportData& data, const std::string& method) {
  Vector counts = Vector::Zero(static_cast<Index>(data.seeds.size()));
  for (const PolicyRun& run : data.policies) {
    if (run.use.method != method) continue;
    const auto seed = std::ranges::find(data.seeds, run.use.seed) - data.seeds.begin();
    counts(seed) += static_cast<double>(run.history.num_rollouts);
  }
  return counts;
}

// A number where all experiments have the same.
Cell count_cell(const Vector& counts) {
  if ((counts.array() == counts(0)).all()) return fmt::format("{:.0f}", counts(0));
  return analysis::summarize(counts);
}

// Returns and successes of a method in the target domain. The standard deviation of successes is
// over the experiments: that over rollouts follows from the mean.
void add_target_cells(const ReportData& data, const std::string& method, Row& row) {
  const Place target = &PolicyTest::target;
  const auto before = tests_of(data, method, true), after = tests_of(data, method, false);
  row.cells.emplace_back(analysis::summarize(pooled(before, target, &PolicyOutcomes::returns)));
  row.cells.emplace_back(analysis::summarize(pooled(after, target, &PolicyOutcomes::returns)));
  if (data.seeds.size() > 1) {
    row.cells.emplace_back(
        analysis::summarize(seed_means(after, target, &PolicyOutcomes::returns)));
  }
  row.cells.emplace_back(
      analysis::summarize(pooled(before, target, &PolicyOutcomes::success)).mean);
  row.cells.emplace_back(analysis::summarize(seed_means(after, target, &PolicyOutcomes::success)));
}

Row method_row(const ReportData& data, const std::string& name) {
  Row row{name, {}};
  if (has_target(data)) add_target_cells(data, name, row);
  if (has_grid(data)) {
    const auto after = tests_of(data, name, false);
    const Place grid = &PolicyTest::grid;
    row.cells.emplace_back(analysis::summarize(pooled(after, grid, &PolicyOutcomes::returns)));
    row.cells.emplace_back(analysis::summarize(seed_means(after, grid, &PolicyOutcomes::success)));
  }
  const MethodConfig& method = data.plan.study.method(name);
  row.cells.emplace_back(std::to_string(num_target_rollouts(data, method)));
  row.cells.emplace_back(std::to_string(num_simulations(data, name)));
  row.cells.push_back(count_cell(num_policy_rollouts(data, name)));
  return row;
}

sim::PolicyTaskInfo task_info(const ReportData& data) { return make_task(data.plan.study)->info(); }

bool has_tests(const ReportData& data) { return has_target(data) || has_grid(data); }

// Where policies were tested, and on how much.
std::string policy_caption(const ReportData& data) {
  const std::string counts =
      "Rollouts and simulations are those of all iterations of one experiment.";
  if (!has_tests(data)) {
    return "Policies, untested: there is no simulated target domain and no grid. " + counts;
  }
  return fmt::format(
      "Policies {}: mean and standard deviation of the return, of at most {}, over {} initial "
      "states of {}; share of successes, with the standard deviation "
      "over the experiments. {}",
      has_target(data) ? "in the target domain" : "over the grid", task_info(data).num_steps,
      data.plan.study.policy.num_test_states, data.each_experiment(), counts);
}

Table policy_table(const ReportData& data) {
  Table table;
  table.name = "policy";
  table.caption = policy_caption(data);
  table.row_header = "Method";
  table.command = data.plan.command;
  if (has_target(data)) {
    add_columns(table, {"return before", "return"});
    if (data.seeds.size() > 1) add_columns(table, {"return, seed means"});
    add_columns(table, {"success before", "success"});
  }
  if (has_grid(data)) add_columns(table, {"return over the grid", "success over the grid"});
  add_columns(table, {"target rollouts", "simulations", "policy rollouts"});
  for (const std::string& method : data.policy_methods()) {
    table.rows.push_back(method_row(data, method));
  }
  if (has_target(data)) table.footnote("before: with the policy that all searches begin with");
  if (has_grid(data)) table.footnote("over the grid: over all of its points, too");
  table.footnote("policy rollouts: of the searches, without tests");
  if (has_tests(data)) table.footnote("success: " + task_info(data).success);
  return table;
}

// The last history of a method and seed.
const PolicyRun& last_run(const ReportData& data, const std::string& method, std::uint64_t seed) {
  const PolicyRun* last = nullptr;
  for (const PolicyRun& run : data.policies) {
    if (run.use.method != method || run.use.seed != seed) continue;
    if (last == nullptr || run.use.iteration > last->use.iteration) last = &run;
  }
  return *last;
}

Row seed_row(const ReportData& data, const std::string& method, std::size_t seed) {
  Row row{fmt::format("{}, {}", method, data.seeds[seed]), {}};
  if (has_target(data)) {
    for (const bool is_before : {true, false}) {
      const PolicyTest* test = tests_of(data, method, is_before).at(seed);
      row.cells.emplace_back(
          analysis::summarize(pooled({test}, &PolicyTest::target, &PolicyOutcomes::returns)));
      row.cells.emplace_back(
          analysis::summarize(pooled({test}, &PolicyTest::target, &PolicyOutcomes::success)).mean);
    }
  }
  const PolicyHistory& history = last_run(data, method, data.seeds[seed]).history;
  const Index last = history.num_rows() - 1;
  row.cells.emplace_back(history.mean_return(last));
  row.cells.emplace_back(history.success_rate(last));
  row.cells.emplace_back(std::to_string(history.num_impossible));
  return row;
}

Table seeds_table(const ReportData& data) {
  Table table;
  table.name = "policy_seeds";
  table.caption =
      "Policies of each experiment: in the target domain, and under what the method believes.";
  table.row_header = "Method, seed";
  table.command = data.plan.command;
  if (has_target(data)) {
    add_columns(table, {"return before", "success before", "return", "success"});
  }
  add_columns(table, {"believed return", "believed success", "impossible parameters"});
  for (const std::string& method : data.policy_methods()) {
    for (std::size_t seed = 0; seed < data.seeds.size(); ++seed) {
      table.rows.push_back(seed_row(data, method, seed));
    }
  }
  table.footnote(
      "believed: over fresh samples of what the method takes the domain parameters for (posterior, "
      "prior or nominal); impossible parameters: samples that were left out of the last search");
  return table;
}

Row parameters_row(const std::string& title, const Vector& policy) {
  Row row{title, {}};
  for (const double value : policy) row.cells.emplace_back(value);
  return row;
}

Table parameters_table(const ReportData& data) {
  Table table;
  table.name = "policy_parameters";
  table.caption = "Parameters of the policies that the searches found.";
  table.row_header = "Method, seed";
  table.command = data.plan.command;
  const sim::PolicyTaskInfo info = task_info(data);
  for (const sim::PolicyParameter& parameter : info.parameters) {
    table.columns.push_back({fmt::format("{} [{}]", parameter.name, parameter.unit), false});
  }
  const PolicyHistory& first = data.policies.front().history;
  table.rows.push_back(parameters_row("before any search", first.policies.row(0).transpose()));
  for (const std::string& method : data.policy_methods()) {
    for (const std::uint64_t seed : data.seeds) {
      const RowMatrix& policies = last_run(data, method, seed).history.policies;
      table.rows.push_back(parameters_row(fmt::format("{}, {}", method, seed),
                                          policies.row(policies.rows() - 1).transpose()));
    }
  }
  return table;
}

// Core-hours of one experiment in a group of stages; what methods share counts for each.
double core_hours(const ReportData& data, const std::string& method, std::uint64_t seed,
                  const std::vector<Stage>& stages) {
  double seconds = 0.0;
  for (const Node& node : data.plan.nodes) {
    if (std::ranges::find(stages, node.stage) == stages.end()) continue;
    if (is_calibration(node) || !is_used_by(node, method, seed)) continue;
    if (!is_complete(data.plan, node)) continue;
    seconds += read_artefact_info(node.path).provenance.cost.core_seconds;
  }
  return seconds / 3600.0;
}

Table cost_table(const ReportData& data) {
  const std::vector<std::pair<std::string, std::vector<Stage>>> groups = {
      {"simulation", {Stage::target, Stage::propose, Stage::simulate}},
      {"inference", {Stage::infer}},
      {"policy search", {Stage::policy}},
      {"all", {Stage::target, Stage::propose, Stage::simulate, Stage::infer, Stage::policy}}};
  Table table;
  table.name = "policy_cost";
  table.caption = "What policies took: core-hours of one experiment, mean and standard deviation.";
  table.row_header = "Method";
  table.command = data.plan.command;
  for (const auto& [title, stages] : groups) table.columns.push_back({title, false});
  for (const std::string& method : data.policy_methods()) {
    Row row{method, {}};
    for (const auto& [title, stages] : groups) {
      Vector hours(static_cast<Index>(data.seeds.size()));
      for (Index s = 0; s < hours.size(); ++s) {
        hours(s) = core_hours(data, method, data.seeds[static_cast<std::size_t>(s)], stages);
      }
      row.cells.emplace_back(analysis::summarize(hours));
    }
    table.rows.push_back(std::move(row));
  }
  table.footnote(
      "what several methods share counts for each of them; without tests and evaluations; times "
      "differ from run to run");
  return table;
}

std::string prose_of(const ReportData& data) {
  const PolicyConfig& policy = data.plan.study.policy;
  return fmt::format(
      "{}; searched for by {}: {} candidates an iteration, each on {} samples of what the method "
      "believes and {} initial states.",
      task_info(data).policy, name_of(policy.search.kind), policy.search.population,
      policy.num_domain_parameters, policy.num_initial_states);
}

}  // namespace

std::optional<analysis::ReportSection> policy_section(const ReportData& data,
                                                      const std::filesystem::path& folder) {
  if (data.policies.empty()) return std::nullopt;
  return analysis::ReportSection{
      "Policies",
      prose_of(data),
      {policy_table(data), seeds_table(data), parameters_table(data), cost_table(data)},
      policy_figures(data, folder)};
}

}  // namespace npdr::pipeline
