#include "pipeline/artefacts/policy_file.h"

namespace npdr::pipeline {
namespace {

void append(Vector& values, double value) {
  values.conservativeResize(values.size() + 1);
  values(values.size() - 1) = value;
}

void append(RowMatrix& rows, const Vector& row) {
  rows.conservativeResize(rows.rows() + 1, row.size());
  rows.row(rows.rows() - 1) = row.transpose();
}

void describe(Layout f, PolicyHistory& history) {
  f.attribute("num_rollouts", history.num_rollouts, "of the whole search");
  f.attribute("num_impossible", history.num_impossible,
              "samples of domain parameters that were left out: physically impossible");
  Layout group = f.group("history");
  const Dim iteration{"T + 1", "iteration"};
  group("policy", history.policies, {iteration, kPolicyParameter},
        "the policy before each iteration, and after the last");
  group("return", history.mean_return, {iteration},
        "its mean return over the domain parameters and initial states of the iteration");
  group("success_rate", history.success_rate, {iteration}, "share of the rollouts that succeed");
  group("completion_rate", history.completion_rate, {iteration},
        "share of them that keep the task's limits");
  group("candidate_return", history.candidate_return, {{"T", "iteration"}, {"M", "candidate"}},
        "mean return of each candidate");
}

void describe(Layout f, inference::PolicySearchState& state) {
  Layout group = f.group("optimizer");
  group.attribute("iteration", state.iteration, "t");
  group("mean", state.mean, {{"Q"}}, "the policy, in the coordinates of the search", kFinite);
  group("covariance", state.covariance, {{"Q"}, {"Q"}}, "of the exploration", kFinite);
  group("best_policies", state.best_policies, {{"B"}, {"Q"}}, "the best first", kFinite);
  group("best_returns", state.best_returns, {{"B"}}, "theirs");
}

void describe(Layout f, PolicyOutcomes& outcomes, const h5::Shape& shape, const Dims& dims) {
  f("return", outcomes.returns, dims, "of a rollout from each initial state", {.shape = shape});
  f("success", outcomes.success, dims, "1 or 0", {.shape = shape});
}

std::vector<double> points_of(const PolicyGridAxis& axis) {
  return axis.is_used() ? axis.points() : std::vector<double>();
}

void describe(Layout f, PolicyOutcomes& outcomes, const PolicyGrid& grid) {
  const std::vector<double> x = points_of(grid.x), y = points_of(grid.y);
  describe(f, outcomes, {std::ssize(x), std::ssize(y), outcomes.returns.cols()},
           {{"X", "x"}, {"Y", "y"}, kRow});
  if (f.reads()) return;
  f.attribute("x_parameter", std::string(grid.x.parameter), "a domain parameter");
  f.attribute("x_values", std::vector(x), "its values (X)");
  f.attribute("y_parameter", std::string(grid.y.parameter), "another");
  f.attribute("y_values", std::vector(y), "its values (Y)");
}

}  // namespace

void PolicyHistory::add(const Vector& policy, const sim::PopulationValues& values, Index i) {
  append(policies, policy);
  append(mean_return, values.mean_return(i));
  append(success_rate, values.success_rate(i));
  append(completion_rate, values.completion_rate(i));
}

void PolicyHistory::add_candidates(const Vector& returns) { append(candidate_return, returns); }

std::vector<Channel> policy_columns(const sim::PolicyTaskInfo& info) {
  std::vector<Channel> columns;
  for (const sim::PolicyParameter& parameter : info.parameters) {
    columns.push_back({parameter.name, parameter.unit});
  }
  return columns;
}

void describe(Layout f, FoundPolicy& found) {
  if (f.writes()) found.policy = found.history.policies.bottomRows(1).transpose();
  f.attribute("optimizer", found.optimizer, "`policy.optimizer`");
  f("policy", found.policy, {kPolicyParameter}, "the policy after the last iteration", kFinite)
      .columns(found.parameters);
  describe(f, found.history);
}

void describe(Layout f, PolicyCheckpoint& checkpoint) {
  Index iteration = checkpoint.history.num_rows();
  f.attribute("iteration", iteration, "t: that are done");
  if (!f.lists()) describe(f, checkpoint.history);  // as in the policy
  describe(f, checkpoint.optimizer);
}

void describe(Layout f, PolicyTest& test) {
  f.attribute("success_means", test.info.success, "when a rollout is one, in words");
  f("policy", test.policy, {kPolicyParameter}, "the policy").columns(policy_columns(test.info));
  f("initial_states", test.initial_states, {kRow, {"C", "channel"}},
    "that rollouts begin from, the same for all methods of a seed")
      .columns(test.states);
  if (auto group = f.group("target", test.target)) {
    describe(*group, *test.target, {test.target->returns.cols()}, {kRow});
  }
  if (auto group = f.group("grid", test.grid)) describe(*group, *test.grid, test.axes);
}

}  // namespace npdr::pipeline
