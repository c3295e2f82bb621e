#include "pipeline/report/verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/begins_at_rest.h"
#include "core/text.h"
#include "pipeline/features/failures.h"
#include "pipeline/report/verdict_parts.h"
#include "pipeline/report/verdict_reasons.h"

namespace npdr::pipeline {
namespace {

// Bonferroni over the method's checks that have a p-value, and the seeds.
double level_of(const ReportData& data, const std::string& method, const DiagnosisRuns& runs) {
  const DiagnoseConfig config = data.checks_of(method);
  const auto has_p_value = [](Check check) { return traits_of(check).has_p_value; };
  const auto tests = static_cast<std::size_t>(std::ranges::count_if(config.checks, has_p_value));
  return config.alpha / static_cast<double>(std::max<std::size_t>(tests * runs.size(), 1));
}

Verdict judge_training(const ReportData& data, const std::string& method,
                       const DiagnosisRuns& runs) {
  std::size_t failed = 0, far = 0;
  double gap = 0.0;
  for (const auto* run : runs) {
    const inference::TrainingCheck& check = *run->result.training;
    failed += check.is_converged ? 0 : 1;
    far += check.is_far_from_training() ? 1 : 0;
    gap += check.generalization_gap / static_cast<double>(runs.size());
  }
  std::string text = failed > 0 ? "NOT converged" + seeds_text(failed, runs.size()) : "converged";
  text += fmt::format(", gap {:.2g} nats", gap);
  if (far > 0) text += ": FAR above training" + seeds_text(far, runs.size());
  const Judgment judgment = failed + far > 0 ? Judgment::fails : Judgment::passes;
  return {Check::training, judgment, text,
          training_reason(runs, data.plan.study.method(method).training)};
}

Verdict judge_p_value(const Study& study, Check check, const DiagnosisRuns& runs, double level) {
  std::size_t failed = 0;
  double smallest = 1.0;
  std::string reason, unknown;
  for (const auto* run : runs) {
    const auto p_values = run->result.p_values();
    const auto p = p_values.find(name_of(check));
    if (p != p_values.end()) smallest = std::min(smallest, p->second);
    const bool fails = p != p_values.end() && p->second < level;
    if (!fails && unknown.empty()) unknown = too_little_to_tell(check, run->result, level);
    if (!fails) continue;
    ++failed;
    if (reason.empty()) reason = failure_reason(check, study, *run);
  }
  const char* sign = runs.size() > 1 && smallest < 1.0 ? "≥" : "=";
  const std::string p_text = fmt::format(", p {} {:.2g}", sign, smallest);
  if (failed > 0) {
    return {check, Judgment::fails,
            std::string(traits_of(check).failure) + seeds_text(failed, runs.size()) + p_text,
            reason};
  }
  if (!unknown.empty()) return {check, Judgment::unknown, "can't tell", unknown};
  return {check, Judgment::passes, "passes" + p_text, ""};
}

Verdict judge_dataset(const ReportData& data) {
  const DatasetFaults& found = data.dataset;
  if (!found.are_grave) return {Check::dataset, Judgment::passes, "passes", ""};
  return {Check::dataset, Judgment::fails, std::string(traits_of(Check::dataset).failure),
          join(found.faults, "; ")};
}

Verdict judge(const ReportData& data, const std::string& method, Check check) {
  switch (check) {
    case Check::sampling:
      return judge_sampling(data, method);
    case Check::residuals:
      return judge_residuals(data, method);
    case Check::bounds:
      return judge_bounds(data, method);
    case Check::contraction:
      return judge_contraction(data, method);
    case Check::fit:
      return judge_fit(data, method);
    case Check::held_out:
      return judge_held_out(data, method);
    case Check::dataset:
      return judge_dataset(data);
    case Check::training:
      return judge_training(data, method, data.diagnoses_of(method));
    default:
      const DiagnosisRuns runs = data.diagnoses_of(method);
      return judge_p_value(data.plan.study, check, runs, level_of(data, method, runs));
  }
}

// Why no check of a method looks at what held-out rollouts would show; "": one does, or needn't.
std::string why_not_held_out(const ReportData& data, const MethodConfig& method) {
  const Study& study = data.plan.study;
  const bool any_left_out =
      study.target.held_out > 0 || study.evaluate.leave_out > 0 || method.num_rollouts > 0;
  if (!study.target.recording || any_left_out || data.target.num_rollouts() < 2) return "";
  return "there are none, so nothing shows whether it is too sure because the simulator lacks "
         "something; set target.held_out = 1 with target.num_rollouts for the others, or "
         "evaluate.leave_out = 2";
}

// The same of the noise of recorded first states, in which simulations begin; "" where each device
// began at rest, and what mends it is for Gaussian noise alone.
std::string why_not_first_states(const ReportData& data, const MethodConfig& method) {
  const Study& study = data.plan.study;
  const ObservationNoise& noise = study.observation_noise;
  const auto family = inference::traits_of(method.algorithm.kind).family;
  const bool learns =
      family == inference::AlgorithmFamily::network || family == inference::AlgorithmFamily::abc;
  const bool is_gaussian = !noise.degrees_of_freedom && !noise.degrees_of_freedom_prior;
  const bool begins_in_motion =
      study.simulator.segment_length > 0 ||
      !std::ranges::all_of(data.target.rollouts, analysis::begins_at_rest);
  if (!study.target.recording || !study.source().gives_motion || !learns || noise.is_silent() ||
      !is_gaussian || !begins_in_motion) {
    return "";
  }
  return "simulations begin in recorded ones as if these were exact, and parameters "
         "may make up for the noise that they have; unless the device began at rest, compare with "
         "a refinement (algorithm = \"refine\", refine.infer_first_states = true)";
}

// The same of calibration, which costs more than some studies spend on inference; "" of methods
// without a network, and where the study itself has chosen checks that are made.
std::string why_not_calibrated(const ReportData& data, const MethodConfig& method) {
  const Study& study = data.plan.study;
  const bool is_left_out = study.diagnose.calibrates() && !study.source().simulates;
  if (study.places.has("diagnose.checks") && !is_left_out) return "";
  const bool has_network =
      inference::traits_of(method.algorithm.kind).family == inference::AlgorithmFamily::network;
  if (!study.source().simulates && has_network) {
    return "a dataset can't be asked for other simulations, so nothing shows whether "
           "posteriors are too sure, or too unsure; keep rows back, and see where their parameters "
           "lie in what npdr sample --x draws for them";
  }
  const bool could_be = study.why_unchecked(Check::coverage, method).empty();
  if (!could_be || data.checks_of(method.name).calibrates()) return "";
  return fmt::format(
      "it wasn't checked, so nothing shows whether posteriors are too sure, or too "
      "unsure, over the prior; a table [diagnose] in the study checks it: for each seed {} more "
      "are simulated, and a posterior is sampled for each",
      study.diagnose.num_simulations);
}

// What no check looked at, of a method that passes all, and why.
void add_unchecked(const ReportData& data, CheckSummary& summary) {
  const MethodConfig& method = data.plan.study.method(summary.method);
  const auto add = [&](std::string_view title, const std::string& why_not) {
    if (why_not.empty()) return;
    summary.unchecked.emplace_back(title);
    summary.reasons.push_back(fmt::format("{}: {}", title, why_not));
  };
  add(traits_of(Check::held_out).title, why_not_held_out(data, method));
  add("Calibration", why_not_calibrated(data, method));
  add("First states", why_not_first_states(data, method));
}

}  // namespace

bool is_miscalibrated(const ReportData& data, const std::string& method) {
  const DiagnosisRuns runs = data.diagnoses_of(method);
  if (runs.empty() || !data.checks_of(method).calibrates()) return false;
  const double level = level_of(data, method, runs);
  return std::ranges::any_of(data.checks_of(method).checks, [&](Check check) {
    return traits_of(check).calibrates &&
           judge_p_value(data.plan.study, check, runs, level).judgment == Judgment::fails;
  });
}

std::string seeds_text(std::size_t failed, std::size_t all) {
  return all == 1 ? "" : fmt::format(" in {} of {} seeds", failed, all);
}

std::vector<Verdict> verdicts_of(const ReportData& data, const std::string& method) {
  const DiagnoseConfig config = data.checks_of(method);
  std::vector<Verdict> verdicts;
  for (const Check check : values_of<Check>()) {
    if (config.has(check)) verdicts.push_back(judge(data, method, check));
  }
  return verdicts;
}

std::vector<CheckSummary> check_summaries(const ReportData& data) {
  std::vector<CheckSummary> summaries;
  for (const std::string& method : data.methods) {
    const std::vector<Verdict> verdicts = verdicts_of(data, method);
    if (verdicts.empty()) continue;
    CheckSummary summary{method, std::ssize(verdicts), {}, {}, {}, {}};
    for (const Verdict& verdict : verdicts) {
      const std::string title(traits_of(verdict.check).title);
      if (verdict.judgment == Judgment::fails) summary.failed.push_back(title);
      if (verdict.judgment == Judgment::unknown) summary.unknown.push_back(title);
      if (!verdict.reason.empty()) summary.reasons.push_back(title + ": " + verdict.reason);
    }
    if (summary.failed.empty() && summary.unknown.empty()) add_unchecked(data, summary);
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

}  // namespace npdr::pipeline
