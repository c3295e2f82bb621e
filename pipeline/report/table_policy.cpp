#include <fmt/format.h>

#include <algorithm>

#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

// Counts of one experiment: of the target domain, of inference, of the search.
Index num_target_rollouts(const ReportData& data, const MethodConfig& method) {
  if (!infers(method)) return 0;
  const Study& study = data.plan.study;
  const Index all = study.target.recording ? data.plan.target.num_rollouts() - study.target.held_out
                                           : study.target.num_rollouts;
  return (method.num_rollouts > 0 ? method.num_rollouts : all) * study.num_iterations_of(method);
}

Index num_simulations_of_rounds(const ReportData& data, const std::string& method) {
  Index count = 0;
  for (const Node& node : data.plan.nodes) {
    if (node.stage != Stage::simulate) continue;
    if (is_used_by(node, method, data.seeds.front())) count += num_rows(data.plan, node);
  }
  return count;
}

// A refinement simulates by itself, beside what its start took, in each iteration.
Vector num_simulations(const ReportData& data, const MethodConfig& method) {
  const Index of_rounds = num_simulations_of_rounds(data, method.name);
  const Index of_start = num_simulations_of_rounds(data, method.refine.start);
  Vector counts =
      Vector::Constant(std::ssize(data.seeds), static_cast<double>(of_rounds + of_start));
  for (Index s = 0; s < counts.size(); ++s) {
    for (const Node& node : data.plan.nodes) {
      const std::uint64_t seed = data.seeds[static_cast<std::size_t>(s)];
      if (node.stage != Stage::infer || !is_used_by(node, method.name, seed)) continue;
      const auto certificate = read_posterior_notes(node).certificate;
      if (certificate) counts(s) += static_cast<double>(certificate->num_draws);
    }
  }
  return counts;
}

Vector num_policy_rollouts(const ReportData& data, const std::string& method) {
  Vector counts = Vector::Zero(static_cast<Index>(data.seeds.size()));
  for (const auto& run : data.policies) {
    if (run.use.method != method) continue;
    const auto seed = std::ranges::find(data.seeds, run.use.seed) - data.seeds.begin();
    counts(seed) += static_cast<double>(run.result.num_rollouts);
  }
  return counts;
}

// A count where all experiments have the same.
Cell count_cell(const Vector& counts) {
  if ((counts.array() == counts(0)).all()) return static_cast<Index>(counts(0));
  return analysis::summarize(counts);
}

// Returns and successes of a method in the target domain. The standard deviation of successes is
// over the experiments: that over rollouts follows from the mean.
void add_target_cells(const ReportData& data, const std::string& method, Row& row) {
  const auto returns = outcome_samples(&PolicyTest::target, &PolicyOutcomes::returns);
  const auto success = outcome_samples(&PolicyTest::target, &PolicyOutcomes::success);
  const auto before = tests_of(data, method, true), after = tests_of(data, method, false);
  row.cells.emplace_back(analysis::summarize(pooled(before, returns)));
  row.cells.emplace_back(analysis::summarize(pooled(after, returns)));
  if (data.seeds.size() > 1) row.cells.emplace_back(summary_of_means(after, returns));
  row.cells.emplace_back(analysis::summarize(pooled(before, success)).mean);
  row.cells.emplace_back(summary_of_means(after, success));
}

void add_grid_cells(const ReportData& data, const std::string& method, Row& row) {
  const auto after = tests_of(data, method, false);
  row.cells.emplace_back(analysis::summarize(
      pooled(after, outcome_samples(&PolicyTest::grid, &PolicyOutcomes::returns))));
  row.cells.emplace_back(
      summary_of_means(after, outcome_samples(&PolicyTest::grid, &PolicyOutcomes::success)));
}

Row method_row(const ReportData& data, const std::string& name) {
  Row row{name, {}};
  if (is_tested_in_target(data)) add_target_cells(data, name, row);
  if (is_tested_on_grid(data)) add_grid_cells(data, name, row);
  const MethodConfig& method = data.plan.study.method(name);
  row.cells.emplace_back(num_target_rollouts(data, method));
  row.cells.push_back(count_cell(num_simulations(data, method)));
  row.cells.push_back(count_cell(num_policy_rollouts(data, name)));
  return row;
}

bool has_tests(const ReportData& data) {
  return is_tested_in_target(data) || is_tested_on_grid(data);
}

// Says where policies were tested, and on how much.
std::string caption_of(const ReportData& data) {
  const std::string counts =
      "Rollouts and simulations are those of all iterations of one experiment.";
  if (!has_tests(data)) {
    return "Policies, untested: there is no simulated target domain and no grid. " + counts;
  }
  return fmt::format(
      "Policies {}: mean and standard deviation of the return, of at most {}, over {} initial "
      "states of {}; share of successes, with the standard deviation "
      "over the experiments. {}",
      is_tested_in_target(data) ? "in the target domain" : "over the grid",
      task_info(data).num_steps, data.plan.study.policy.num_test_states, data.each_experiment(),
      counts);
}

Table make_policy_table(const ReportData& data) {
  const bool has_target = is_tested_in_target(data), has_grid = is_tested_on_grid(data);
  Table table = empty_table(caption_of(data), "Method", {});
  if (has_target) {
    add_columns(table, {"return before", "return"});
    if (data.seeds.size() > 1) add_columns(table, {"return, seed means"});
    add_columns(table, {"success before", "success"});
  }
  if (has_grid) add_columns(table, {"return over the grid", "success over the grid"});
  add_columns(table, {"target rollouts", "simulations", "policy rollouts"});
  for (const std::string& method : data.policy_methods()) {
    table.rows.push_back(method_row(data, method));
  }
  if (has_target) table.footnote("before: with the policy that all searches begin with");
  if (has_grid) table.footnote("over the grid: over all of its points, too");
  table.footnote("policy rollouts: of the searches, without tests");
  const bool chooses_power = std::ranges::any_of(data.policy_methods(), [&](const auto& method) {
    return data.plan.study.method(method).refine.sampling.cross_validate;
  });
  if (chooses_power) table.footnote("simulations: without those that score powers");
  if (has_tests(data)) table.footnote("success: " + task_info(data).success);
  return table;
}

}  // namespace

/// Returns and successes of each method before and after its searches, and the rollouts and
/// simulations that it took.
TableEntry policy_table() { return {"policy", Section::policies, has_policies, make_policy_table}; }

}  // namespace npdr::pipeline
