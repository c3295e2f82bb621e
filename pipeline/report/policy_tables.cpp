#include <fmt/format.h>

#include <algorithm>

#include "pipeline/plan/completeness.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

bool is_tested_in_target(const ReportData& data) {
  return data.plan.study.target.truth.has_value();
}

bool is_tested_on_grid(const ReportData& data) { return data.plan.study.policy.grid.is_used(); }

bool is_tested(const ReportData& data) {
  return is_tested_in_target(data) || is_tested_on_grid(data);
}

// In the target domain or on the grid.
using TestPlace = std::optional<PolicyOutcomes> PolicyTest::*;

// One outcome of all rollouts of a test, to pool.
auto outcome_samples(TestPlace place, Outcome outcome) {
  return [=](const PolicyTest* test) -> Vector {
    return ((*(test->*place)).*outcome).reshaped<Eigen::RowMajor>();
  };
}

// A row for each method that has searched for a policy.
TableOf<std::string> table_of_policy_methods(const ReportData& data, std::string caption) {
  return {.caption = std::move(caption),
          .row_header = "Method",
          .rows = data.policy_methods(),
          .label = std::identity()};
}

// Nodes of some stages that an experiment uses, for other things than calibration.
std::vector<const Node*> nodes_of(const ReportData& data, const std::string& method,
                                  std::uint64_t seed, const std::vector<Stage>& stages) {
  const auto is_its = [&](const Use& use) { return use.method == method && use.seed == seed; };
  std::vector<const Node*> nodes;
  for (const Node& node : data.plan.nodes) {
    const bool is_wanted = std::ranges::count(stages, node.stage) > 0 && !is_calibration(node);
    if (is_wanted && std::ranges::any_of(node.uses, is_its)) nodes.push_back(&node);
  }
  return nodes;
}

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
  for (const Node* node : nodes_of(data, method, data.seeds.front(), {Stage::simulate})) {
    count += num_rows(data.plan, *node);
  }
  return count;
}

// A refinement simulates by itself, beside what its start took, in each iteration.
Vector num_simulations(const ReportData& data, const MethodConfig& method) {
  const Index of_rounds = num_simulations_of_rounds(data, method.name);
  const Index of_start = num_simulations_of_rounds(data, method.refine.start);
  return each(data.seeds, [&](std::uint64_t seed) {
    auto count = static_cast<double>(of_rounds + of_start);
    for (const Node* node : nodes_of(data, method.name, seed, {Stage::infer})) {
      const auto certificate = read_posterior_notes(*node).certificate;
      if (certificate) count += static_cast<double>(certificate->num_draws);
    }
    return count;
  });
}

Vector num_policy_rollouts(const ReportData& data, const std::string& method) {
  return each(data.seeds, [&](std::uint64_t seed) {
    double count = 0.0;
    for (const PolicyHistory* history : histories_of(data, method, seed)) {
      count += static_cast<double>(history->num_rollouts);
    }
    return count;
  });
}

// A count where all experiments have the same.
Cell count_cell(const Vector& counts) {
  if ((counts.array() == counts(0)).all()) return static_cast<Index>(counts(0));
  return analysis::summarize(counts);
}

// Says where policies were tested, and on how much.
std::string caption_of_policies(const ReportData& data) {
  const std::string counts =
      "Rollouts and simulations are those of all iterations of one experiment.";
  if (!is_tested(data)) {
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

// Returns and successes. The standard deviation of successes is over the experiments: that over
// rollouts follows from the mean.
void add_tests(const ReportData& data, TableOf<std::string>& table) {
  using Name = const std::string&;
  using enum Searches;
  const auto all = [&data](Name method, Searches searches, TestPlace place, Outcome outcome) {
    return analysis::summarize(
        pooled(tests_of(data, method, searches), outcome_samples(place, outcome)));
  };
  const auto seed_means = [&data](Name method, TestPlace place, Outcome outcome) {
    return summary_of_means(tests_of(data, method, after), outcome_samples(place, outcome));
  };
  constexpr auto target = &PolicyTest::target, grid = &PolicyTest::grid;
  constexpr auto returns = &PolicyOutcomes::returns, success = &PolicyOutcomes::success;
  if (is_tested_in_target(data)) {
    table.add("return before", [=](Name m) { return all(m, before, target, returns); });
    table.add("return", [=](Name m) { return all(m, after, target, returns); });
    if (data.seeds.size() > 1) {
      table.add("return, seed means", [=](Name m) { return seed_means(m, target, returns); });
    }
    table.add("success before", [=](Name m) { return all(m, before, target, success).mean; });
    table.add("success", [=](Name m) { return seed_means(m, target, success); });
    table.last_notes.emplace_back("before: with the policy that all searches begin with");
  }
  if (is_tested_on_grid(data)) {
    table.add("return over the grid", [=](Name m) { return all(m, after, grid, returns); });
    table.add("success over the grid", [=](Name m) { return seed_means(m, grid, success); });
    table.last_notes.emplace_back("over the grid: over all of its points, too");
  }
}

// A method and seed: the policy that its last search found.
struct PolicyOfSeed {
  std::string label;
  Vector parameters;
  const PolicyHistory* last_search = nullptr;
  std::size_t seed = 0;  // its place among the seeds
  std::string method = {};
};

TableOf<PolicyOfSeed> table_of_policies_of_seeds(const ReportData& data, std::string caption) {
  TableOf<PolicyOfSeed> table{.caption = std::move(caption),
                              .row_header = "Method, seed",
                              .rows = {},
                              .label = &PolicyOfSeed::label};
  for (const std::string& method : data.policy_methods()) {
    for (std::size_t s = 0; s < data.seeds.size(); ++s) {
      const PolicyHistory* last = histories_of(data, method, data.seeds[s]).back();
      table.rows.push_back({fmt::format("{}, {}", method, data.seeds[s]),
                            last->policies.bottomRows(1).transpose(), last, s, method});
    }
  }
  return table;
}

}  // namespace

/// Returns and successes of each method before and after its searches, and the rollouts and
/// simulations that it took.
std::optional<Table> policy_table(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  const auto config = [&](const std::string& name) -> const MethodConfig& {
    return data.plan.study.method(name);
  };
  auto table = table_of_policy_methods(data, caption_of_policies(data));
  add_tests(data, table);
  table.add("target rollouts",
            [&](const std::string& name) { return num_target_rollouts(data, config(name)); });
  table.add("simulations", [&](const std::string& name) {
    return count_cell(num_simulations(data, config(name)));
  });
  table.add("policy rollouts",
            [&](const std::string& name) { return count_cell(num_policy_rollouts(data, name)); });
  table.last_notes.emplace_back("policy rollouts: of the searches, without tests");
  const bool chooses_power = std::ranges::any_of(table.rows, [&](const std::string& name) {
    return config(name).refine.sampling.cross_validate;
  });
  if (chooses_power) {
    table.last_notes.emplace_back("simulations: without those that score powers");
  }
  if (is_tested(data)) table.last_notes.push_back("success: " + task_info(data).success);
  return table.make();
}

/// One row a method: core-hours. They are times, so that two runs that computed the same differ.
std::optional<Table> policy_cost_table(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  auto table = table_of_policy_methods(
      data, "What policies took: core-hours of one experiment, mean and standard deviation.");
  // What methods share counts for each.
  const auto add = [&](const char* title, const std::vector<Stage>& stages) {
    table.add(title, [&data, stages](const std::string& method) {
      return analysis::summarize(each(data.seeds, [&](std::uint64_t seed) {
        double seconds = 0.0;
        for (const Node* node : nodes_of(data, method, seed, stages)) {
          if (!is_complete(data.plan, *node)) continue;
          seconds += read_artefact_info(node->path).provenance.cost.core_seconds;
        }
        return seconds / 3600.0;
      }));
    });
  };
  add("simulation", {Stage::target, Stage::propose, Stage::simulate});
  add("inference", {Stage::infer});
  add("policy search", {Stage::policy});
  add("all", {Stage::target, Stage::propose, Stage::simulate, Stage::infer, Stage::policy});
  table.last_notes = {
      "what several methods share counts for each of them; without tests and evaluations; times "
      "differ from run to run"};
  return table.make();
}

/// One row a method and seed: its policy in the target domain and under what the method believes.
std::optional<Table> policy_seeds_table(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  using Policy = const PolicyOfSeed&;
  auto table = table_of_policies_of_seeds(
      data,
      "Policies of each experiment: in the target domain, and under what the method believes.");
  if (is_tested_in_target(data)) {
    const auto in_target = [&data](Policy policy, Searches searches, Outcome outcome) {
      const PolicyTest* test = tests_of(data, policy.method, searches).at(policy.seed);
      return analysis::summarize(outcome_samples(&PolicyTest::target, outcome)(test));
    };
    constexpr auto returns = &PolicyOutcomes::returns, success = &PolicyOutcomes::success;
    using enum Searches;
    table.add("return before", [=](Policy p) { return in_target(p, before, returns); });
    table.add("success before", [=](Policy p) { return in_target(p, before, success).mean; });
    table.add("return", [=](Policy p) { return in_target(p, after, returns); });
    table.add("success", [=](Policy p) { return in_target(p, after, success).mean; });
  }
  const auto last = [](const Vector& values) { return values(values.size() - 1); };
  table.add("believed return", [=](Policy p) { return last(p.last_search->mean_return); });
  table.add("believed success", [=](Policy p) { return last(p.last_search->success_rate); });
  table.add("impossible parameters", [](Policy p) { return p.last_search->num_impossible; });
  table.last_notes = {
      "believed: over fresh samples of what the method takes the domain parameters for (posterior, "
      "prior or nominal); impossible parameters: samples that were left out of the last search"};
  return table.make();
}

/// One row a method and seed: the parameters of the policy that was found.
std::optional<Table> policy_parameters_table(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  auto table =
      table_of_policies_of_seeds(data, "Parameters of the policies that the searches found.");
  const Vector first = data.policies.front().result.policies.row(0).transpose();
  table.rows.insert(table.rows.begin(), {"before any search", first});
  Index p = 0;
  for (const sim::PolicyParameter& parameter : task_info(data).parameters) {
    table.add(fmt::format("{} [{}]", parameter.name, parameter.unit),
              [p](const PolicyOfSeed& policy) { return policy.parameters(p); });
    ++p;
  }
  return table.make();
}

}  // namespace npdr::pipeline
