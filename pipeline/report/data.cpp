#include "pipeline/report/data.h"

#include <algorithm>

#include "core/text.h"

namespace npdr::pipeline {

std::vector<const EvaluatedRun*> ReportData::runs_of(const std::string& method, Index round) const {
  std::vector<const EvaluatedRun*> found;
  for (const EvaluatedRun& run : runs) {
    if (run.use.method != method) continue;
    if (round > 0 ? run.use.round == round : run.last_round) found.push_back(&run);
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

std::vector<std::string> ReportData::policy_methods() const {
  std::vector<std::string> names;
  for (const MethodConfig& method : plan.study.methods) {
    const auto is_its = [&](const PolicyRun& run) { return run.use.method == method.name; };
    if (std::ranges::any_of(policies, is_its)) names.push_back(method.name);
  }
  return names;
}

bool ReportData::is_inferred(const std::string& method, Index d) const {
  const auto varies = [&](const EvaluatedRun* run) {
    const auto column = run->evaluation.theta.col(d);
    return column.size() < 2 || (column.array() != column(0)).any();
  };
  return std::ranges::any_of(runs_of(method), varies);
}

ReportData read_report_data(const Plan& plan, const Node& node) {
  ReportData data{plan, plan.source->info(),
                  {},   {},
                  {},   read_baseline(*plan.inputs(node, Stage::baseline).front())};
  for (const Node* evaluation : plan.inputs(node, Stage::evaluate)) {
    const Node& posterior = *plan.inputs(*evaluation, Stage::infer).front();
    for (const Use& use : evaluation->uses) {
      const bool is_last = use.round == plan.study.method(use.method).algorithm.num_rounds;
      data.runs.push_back(
          {use, is_last, read_evaluation(*evaluation), read_posterior_notes(posterior)});
    }
  }
  for (const Node* diagnosis : plan.inputs(node, Stage::diagnose)) {
    for (const Use& use : diagnosis->uses)
      data.diagnoses.push_back({use, read_diagnosis(*diagnosis)});
  }
  for (const Node* policy : plan.inputs(node, Stage::policy)) {
    for (const Use& use : policy->uses)
      data.policies.push_back({use, read_policy_history(*policy)});
  }
  for (const Node* test : plan.inputs(node, Stage::policy_test)) {
    for (const Use& use : test->uses) data.policy_tests.push_back({use, read_policy_test(*test)});
  }
  const auto has_run = [&](const auto& matches) {
    return std::any_of(data.runs.begin(), data.runs.end(), matches);
  };
  for (const MethodConfig& method : plan.study.methods) {
    if (has_run([&](const auto& run) { return run.use.method == method.name; })) {
      data.methods.push_back(method.name);
    }
  }
  for (const std::uint64_t seed : plan.study.seeds) {
    const auto is_of_seed = [&](const auto& run) { return run.use.seed == seed; };
    if (has_run(is_of_seed) || std::ranges::any_of(data.policies, is_of_seed)) {
      data.seeds.push_back(seed);
    }
  }
  return data;
}

}  // namespace npdr::pipeline
