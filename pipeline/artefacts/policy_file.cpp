#include "pipeline/artefacts/policy_file.h"

#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/schemas.h"

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

void describe(Layout f, Vector& policy, const sim::PolicyTaskInfo& info) {
  f("policy", policy, {kPolicyParameter}, "the policy after the last iteration", kFinite)
      .columns(policy_columns(info));
}

void describe_optimizer(Layout f, std::string name) {
  f.attribute("optimizer", name, "`policy.optimizer`");
}

void describe_iteration(Layout f, Index iteration) {
  f.attribute("iteration", iteration, "t: that are done");
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

void write_policy(h5::File& file, inference::PolicyOptimizerKind optimizer,
                  const sim::PolicyTaskInfo& info, PolicyHistory history) {
  const Layout f = Layout::writer(file);
  Vector policy = history.policies.bottomRows(1).transpose();
  describe_optimizer(f, name_of(optimizer));
  describe(f, policy, info);
  describe(f, history);
}

Vector read_policy(const ArtefactFile& policy) {
  const h5::File file = open_artefact(policy, kPolicySchema);
  Vector parameters;
  describe(Layout::reader(file), parameters, {});
  return parameters;
}

PolicyHistory read_policy_history(const ArtefactFile& policy) {
  const h5::File file = open_artefact(policy, kPolicySchema);
  PolicyHistory history;
  describe(Layout::reader(file), history);
  return history;
}

void write_policy_checkpoint(const std::filesystem::path& path, const Identity& identity,
                             PolicyCheckpoint checkpoint) {
  ArtefactWriter writer(path, kPolicyCheckpointSchema, identity);
  writer.add_cost(checkpoint.cost);
  const Layout f = Layout::writer(writer.file());
  describe_iteration(f, checkpoint.history.num_rows());
  describe(f, checkpoint.history);
  describe(f, checkpoint.optimizer);
  writer.finish();
}

std::optional<PolicyCheckpoint> read_policy_checkpoint(const ArtefactFile& checkpoint) {
  const auto file = open_artefact_if_there(checkpoint, kPolicyCheckpointSchema);
  if (!file) return std::nullopt;
  PolicyCheckpoint found{.history = {}, .optimizer = {}, .cost = provenance_of(*file).cost};
  describe(Layout::reader(*file), found.history);
  describe(Layout::reader(*file), found.optimizer);
  return found;
}

void list_policy(Layout f) {
  Vector policy;
  PolicyHistory history;
  describe_optimizer(f, "");
  describe(f, policy, {});
  describe(f, history);
}

void list_policy_checkpoint(Layout f) {
  inference::PolicySearchState state;
  describe_iteration(f, 0);
  describe(f, state);
}

}  // namespace npdr::pipeline
