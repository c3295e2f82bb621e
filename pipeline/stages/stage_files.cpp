#include "pipeline/stages/stage_files.h"

#include "pipeline/plan/schemas.h"
#include "pipeline/store/feature_file.h"
#include "pipeline/store/recording.h"

namespace npdr::pipeline {

Target all_rollouts(const Plan& plan) {
  const Study& study = plan.study;
  if (study.target.recording) return plan.target;
  const auto simulator = sim::make_simulator(study.simulator);
  return simulator->behave(nominal_theta(study, simulator->info(), *study.target.truth),
                           study.target.num_rollouts + study.target.held_out, study.target.seed);
}

Target read_target_artefact(const Node& target) {
  const bool is_observation = open_artefact(target.path, kTargetSchema, target.key).has("x");
  return is_observation ? read_observation(target.path, {}) : read_recording(target.path);
}

Target read_target(const Plan& plan, const Node& node, Index num_rollouts) {
  Target target = read_target_artefact(*plan.inputs(node, Stage::target).front());
  return num_rollouts > 0 ? target.first(num_rollouts) : target;
}

Target read_seen_target(const Plan& plan, const Node& node) {
  const Use& use = node.uses.front();
  return read_target(plan, node, num_rollouts_seen(plan.study.method(use.method), use));
}

std::optional<Target> read_held_out(const Plan& plan, const Node& node) {
  const auto sources = plan.inputs(node, Stage::held_out);
  if (sources.empty()) return std::nullopt;
  return read_target_artefact(*sources.front());
}

h5::Dataset open_proposal(const Node& node) {
  h5::Dataset theta = open_artefact(node.path, kProposalSchema, node.key).dataset("theta");
  theta.require_shape({-1, -1});
  return theta;
}

RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows) {
  RowMatrix values(rows.end - rows.begin, theta.row_size());
  const std::span<double> all(values.data(), static_cast<std::size_t>(values.size()));
  theta.read_rows<double>(rows.begin, values.rows(), all);
  theta.require_finite<double>(all);
  return values;
}

Vector nominal_theta(const Study& study, const sim::SimulatorInfo& info,
                     const std::map<std::string, double>& values) {
  std::map<std::string, double> all = values;
  all.insert(study.simulator.parameters.begin(), study.simulator.parameters.end());
  return sim::complete_theta(info, all);
}

RowMatrix complete_theta(const Plan& plan, const sim::SimulatorInfo& info, const RowMatrix& theta) {
  const Vector base = nominal_theta(plan.study, info, {});
  RowMatrix all = base.transpose().replicate(theta.rows(), 1);
  Index column = 0;
  for (const inference::Marginal& marginal : plan.study.prior) {
    all.col(sim::parameter_index(info, marginal.name)) = theta.col(column++);
  }
  return all;
}

void describe_theta(h5::Dataset& dataset, const Plan& plan) {
  std::vector<std::string> labels, units;
  std::vector<double> lower, upper;
  for (const inference::Marginal& marginal : plan.study.prior) {
    labels.push_back(marginal.name);
    units.push_back(marginal.unit);
    lower.push_back(marginal.lower());
    upper.push_back(marginal.upper());
  }
  dataset.set_attribute("labels", labels);
  dataset.set_attribute("units", units);
  dataset.set_attribute("prior_lower", lower);
  dataset.set_attribute("prior_upper", upper);
  dataset.label_dimensions({"row", "parameter"});
}

void write_theta(h5::Group& group, const Plan& plan, const RowMatrix& theta) {
  group.write("theta", theta);
  h5::Dataset dataset = group.dataset("theta");
  describe_theta(dataset, plan);
}

}  // namespace npdr::pipeline
