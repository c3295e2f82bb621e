#include "pipeline/findings/data.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {

std::vector<const EvaluatedRun*> ReportData::runs_of(const std::string& method, Index round) const {
  std::vector<const EvaluatedRun*> found;
  for (const EvaluatedRun& run : runs) {
    if (run.use.method != method) continue;
    if (round > 0 ? run.use.round == round : run.last_round) found.push_back(&run);
  }
  return found;
}

std::vector<const EvaluatedRun*> ReportData::folds_of(const Use& use) const {
  std::vector<const EvaluatedRun*> found;
  for (const EvaluatedRun& run : folds) {
    if (run.use.method == use.method && run.use.seed == use.seed) found.push_back(&run);
  }
  return found;
}

std::string ReportData::experiments() const {
  return counted(static_cast<Index>(seeds.size()), "experiment") +
         (seeds.size() == 1 ? " (seed)" : " (seeds)");
}

std::string ReportData::each_experiment() const {
  return (seeds.size() == 1 ? "" : "each of ") + experiments();
}

std::vector<const ResultOf<Diagnosis>*> ReportData::diagnoses_of(const std::string& method) const {
  std::vector<const ResultOf<Diagnosis>*> found;
  for (const auto& run : diagnoses) {
    if (run.use.method == method) found.push_back(&run);
  }
  return found;
}

DiagnoseConfig ReportData::checks_of(const std::string& method) const {
  return plan.study.diagnose_of(plan.study.method(method));
}

std::vector<std::string> ReportData::policy_methods() const {
  std::vector<std::string> names;
  for (const MethodConfig& method : plan.study.methods) {
    const auto is_its = [&](const auto& run) { return run.use.method == method.name; };
    if (std::ranges::any_of(policies, is_its)) names.push_back(method.name);
  }
  return names;
}

bool ReportData::is_inferred(const std::string& method, Index d) const {
  const inference::Marginal& its = marginal(d);
  // Samples of a network that extrapolates may all lie on a bound.
  const auto is_bound = [&](double value) {
    const double rounding = 1e-12 * std::abs(value);
    return value <= its.lower() + rounding || value >= its.upper() - rounding;
  };
  const auto varies = [&](const EvaluatedRun* run) {
    const auto column = run->evaluation.theta.col(d);
    return column.size() < 2 || (column.array() != column(0)).any() || is_bound(column(0));
  };
  return std::ranges::any_of(runs_of(method), varies);
}

const sim::Parameter& ReportData::parameter(Index d) const {
  const Index p = sim::parameter_index(info, marginal(d).name);
  return info.parameters[static_cast<std::size_t>(p)];
}

double ReportData::period_of(Index d) const { return parameter(d).period; }

analysis::Summary ReportData::summary_of(Index d, const Eigen::Ref<const Vector>& samples) const {
  const inference::Prior prior({marginal(d)});
  const double median = prior.to_theta(RowMatrix::Zero(1, 1))(0, 0);
  return analysis::summarize_periodic(samples, period_of(d), median);
}

bool predicts_features(const ReportData& data) {
  return !data.methods.empty() && data.plan.study.source().predicts_features();
}

bool has_rollout_scores(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.evaluation.scores.seen.has_value(); });
}

namespace {

void read_artefacts(const Plan& plan, const Node& node, ReportData& data) {
  for (const Node* evaluation : plan.inputs(node, "evaluation")) {
    const Node& posterior = plan.input(*evaluation, "posterior");
    for (const Use& use : evaluation->uses) {
      const bool is_last = use.round == plan.study.method(use.method).algorithm.num_rounds;
      (use.fold > 0 ? data.folds : data.runs)
          .push_back(
              {use, is_last, kEvaluationSchema.read(*evaluation), read_posterior_notes(posterior)});
    }
  }
  const auto collect = [&](std::string_view name, auto& results, const auto& read) {
    for (const Node* input : plan.inputs(node, name)) {
      for (const Use& use : input->uses) results.push_back({use, read(*input)});
    }
  };
  collect("diagnosis", data.diagnoses, [](const Node& n) { return kDiagnosisSchema.read(n); });
  collect("policy", data.policies, [](const Node& n) { return kPolicySchema.read(n).history; });
  collect("policy_test", data.policy_tests,
          [](const Node& n) { return kPolicyTestSchema.read(n); });
  data.target = read_target_artefact(plan.node(Stage::target, {}));
  if (plan.study.target.held_out > 0) {
    data.held_out = read_target_artefact(plan.node(Stage::held_out, {}));
  }
}

}  // namespace

ReportData read_report_data(const Plan& plan, const Node& node) {
  ReportData data{
      plan, plan.source->info(), {}, {}, {}, kBaselineSchema.read(plan.input(node, "baseline"))};
  read_artefacts(plan, node, data);
  // Methods and seeds of which there is anything, in the study's order.
  for (const MethodConfig& method : plan.study.methods) {
    const auto is_its = [&](const auto& run) { return run.use.method == method.name; };
    if (std::ranges::any_of(data.runs, is_its)) data.methods.push_back(method.name);
  }
  for (const std::uint64_t seed : plan.study.seeds) {
    const auto is_its = [&](const auto& run) { return run.use.seed == seed; };
    if (std::ranges::any_of(data.runs, is_its) || std::ranges::any_of(data.policies, is_its)) {
      data.seeds.push_back(seed);
    }
  }
  if (has_posteriors(data)) {
    data.dataset = find_in_dataset(plan, data.methods, data.seeds.front());
  }
  return data;
}

}  // namespace npdr::pipeline
