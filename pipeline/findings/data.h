/// The artefacts that posteriors are judged by, and the report of a study is made from.
#pragma once

#include <vector>

#include "analysis/summary.h"
#include "core/finding.h"
#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// One method, seed and round.
struct EvaluatedRun {
  Use use;
  bool last_round = false;
  Evaluation evaluation;
  PosteriorNotes notes;
};

/// Another artefact of a method and seed.
template <class Result>
struct ResultOf {
  Use use;
  Result result;
};

struct ReportData {
  const Plan& plan;
  sim::SimulatorInfo info;
  std::vector<std::string> methods;  ///< that infer, in the study's order
  std::vector<std::uint64_t> seeds;
  std::vector<EvaluatedRun> runs;
  Baseline baseline;
  std::vector<ResultOf<Diagnosis>> diagnoses = {};      ///< where the study asks for any
  std::vector<ResultOf<PolicyHistory>> policies = {};   ///< of a study with [policy], by iteration
  std::vector<ResultOf<PolicyTest>> policy_tests = {};  ///< iteration 0: before any search
  Target target = {};  ///< all rollouts that inference may see, or x_o
  std::optional<Target> held_out = {};
  std::vector<EvaluatedRun> folds = {};  ///< where the study leaves any out
  Findings dataset = {};                 ///< in the rows of the first seed

  /// Runs of the method, in the order of seeds: of its last round, or of `round` when that is > 0.
  std::vector<const EvaluatedRun*> runs_of(const std::string& method, Index round = 0) const;

  /// The runs of a method and seed that a fold was left out of.
  std::vector<const EvaluatedRun*> folds_of(const Use& use) const;

  /// Checks of the method, in the order of seeds.
  std::vector<const ResultOf<Diagnosis>*> diagnoses_of(const std::string& method) const;
  /// Parameter d of the prior.
  const inference::Marginal& marginal(Index d) const {
    return plan.study.prior[static_cast<std::size_t>(d)];
  }
  /// The checks that mean something to the method.
  DiagnoseConfig checks_of(const std::string& method) const;

  /// Methods that have searched for a policy, in the study's order.
  std::vector<std::string> policy_methods() const;
  /// "5 experiments (seeds)", "1 experiment (seed)".
  std::string experiments() const;
  /// "each of 5 experiments (seeds)", "1 experiment (seed)".
  std::string each_experiment() const;

  /// True where the method's samples differ in parameter d of the prior: some methods take
  /// parameters as known that others infer.
  bool is_inferred(const std::string& method, Index d) const;
  /// The simulator's.
  const sim::Parameter& parameter(Index d) const;
  /// Values of parameter d of the prior that far apart are the same system; 0: none are.
  double period_of(Index d) const;
  /// Mean and deviation of samples of that parameter; of a periodic one in the period around the
  /// prior's median.
  analysis::Summary summary_of(Index d, const Eigen::Ref<const Vector>& samples) const;
};

/// Conditions under which several tables and figures exist.
inline bool has_posteriors(const ReportData& data) { return !data.methods.empty(); }
inline bool has_policies(const ReportData& data) { return !data.policies.empty(); }
bool predicts_features(const ReportData& data);
bool has_rollout_scores(const ReportData& data);

/// One number for each item: (items).
template <class Items, class Number>
Vector each(const Items& items, const Number& number_of) {
  Vector numbers(static_cast<Index>(items.size()));
  Index i = 0;
  for (const auto& item : items) numbers(i++) = number_of(item);
  return numbers;
}

/// Reads all that `node` needs. Throws InputError.
ReportData read_report_data(const Plan& plan, const Node& node);

}  // namespace npdr::pipeline
