#include "pipeline/artefacts/policy_file.h"

#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/column_labels.h"

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

void write_history(h5::File& file, const PolicyHistory& history) {
  file.set_attribute("num_rollouts", history.num_rollouts);
  file.set_attribute("num_impossible", history.num_impossible);
  h5::Group group = file.create_group("history");
  group.write("policy", history.policies).label_dimensions({"iteration", "parameter"});
  group.write("return", history.mean_return).label_dimensions({"iteration"});
  group.write("success_rate", history.success_rate).label_dimensions({"iteration"});
  group.write("completion_rate", history.completion_rate).label_dimensions({"iteration"});
  group.write("candidate_return", history.candidate_return)
      .label_dimensions({"iteration", "candidate"});
}

PolicyHistory read_history(const h5::File& file) {
  PolicyHistory history;
  history.num_rollouts = file.attribute<Index>("num_rollouts");
  history.num_impossible = file.attribute<Index>("num_impossible");
  const h5::Group group = file.group("history");
  history.policies = group.read_matrix<double>("policy");
  const Index rows = history.num_rows();
  history.mean_return = group.read_vector<double>("return", rows);
  history.success_rate = group.read_vector<double>("success_rate", rows);
  history.completion_rate = group.read_vector<double>("completion_rate", rows);
  history.candidate_return = group.read_matrix<double>("candidate_return");
  return history;
}

void write_state(h5::File& file, const inference::PolicySearchState& state) {
  h5::Group group = file.create_group("optimizer");
  group.set_attribute("iteration", state.iteration);
  group.write("mean", state.mean);
  group.write("covariance", state.covariance);
  group.write("best_policies", state.best_policies);
  group.write("best_returns", state.best_returns);
}

inference::PolicySearchState read_state(const h5::File& file) {
  const h5::Group group = file.group("optimizer");
  inference::PolicySearchState state;
  state.iteration = group.attribute<Index>("iteration");
  state.mean = group.read_vector<double>("mean", -1, h5::Values::finite);
  const Index q = state.mean.size();
  state.covariance = group.read_matrix<double>("covariance", q, q, h5::Values::finite);
  state.best_policies = group.read_matrix<double>("best_policies", -1, q, h5::Values::finite);
  state.best_returns = group.read_vector<double>("best_returns", state.best_policies.rows());
  return state;
}

}  // namespace

void PolicyHistory::add(const Vector& policy, const sim::PopulationValues& values, Index i) {
  append(policies, policy);
  append(mean_return, values.mean_return(i));
  append(success_rate, values.success_rate(i));
  append(completion_rate, values.completion_rate(i));
}

void PolicyHistory::add_candidates(const Vector& returns) { append(candidate_return, returns); }

void write_policy_parameters(h5::File& file, const sim::PolicyTaskInfo& info,
                             const Vector& policy) {
  std::vector<Channel> columns;
  for (const sim::PolicyParameter& parameter : info.parameters) {
    columns.push_back({parameter.name, parameter.unit});
  }
  h5::Dataset dataset = file.write("policy", policy);
  describe_columns(dataset, columns);
  dataset.label_dimensions({"parameter"});
}

void write_policy(h5::File& file, inference::PolicyOptimizerKind optimizer,
                  const sim::PolicyTaskInfo& info, const PolicyHistory& history) {
  const Vector policy = history.policies.bottomRows(1).transpose();
  file.set_attribute("optimizer", name_of(optimizer));
  write_policy_parameters(file, info, policy);
  write_history(file, history);
}

Vector read_policy(const ArtefactFile& policy) {
  return open_artefact(policy, kPolicySchema).read_vector<double>("policy", -1, h5::Values::finite);
}

PolicyHistory read_policy_history(const ArtefactFile& policy) {
  return read_history(open_artefact(policy, kPolicySchema));
}

void write_policy_checkpoint(const std::filesystem::path& path, const Identity& identity,
                             const PolicyCheckpoint& checkpoint) {
  ArtefactWriter writer(path, kPolicyCheckpointSchema, identity);
  writer.add_cost(checkpoint.cost);
  writer.file().set_attribute("iteration", checkpoint.history.num_rows());
  write_history(writer.file(), checkpoint.history);
  write_state(writer.file(), checkpoint.optimizer);
  writer.finish();
}

std::optional<PolicyCheckpoint> read_policy_checkpoint(const ArtefactFile& checkpoint) {
  const auto file = open_artefact_if_there(checkpoint, kPolicyCheckpointSchema);
  if (!file) return std::nullopt;
  return PolicyCheckpoint{read_history(*file), read_state(*file), provenance_of(*file).cost};
}

}  // namespace npdr::pipeline
