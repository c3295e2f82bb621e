#include "pipeline/artefacts/policy_file.h"

#include "pipeline/artefacts/described_artefact.h"

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
template struct Artefact<FoundPolicy>;

void describe(Layout f, PolicyCheckpoint& checkpoint) {
  Index iteration = checkpoint.history.num_rows();
  f.attribute("iteration", iteration, "t: that are done");
  if (!f.lists()) describe(f, checkpoint.history);  // as in the policy
  describe(f, checkpoint.optimizer);
}
template struct Artefact<PolicyCheckpoint>;

}  // namespace npdr::pipeline
