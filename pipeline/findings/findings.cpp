#include "pipeline/findings/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "analysis/begins_at_rest.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// Why no check of a method looks at what held-out rollouts would show; "": one does, or needn't.
std::string why_not_held_out(const MethodResults& m) {
  const bool any_left_out =
      m.study.target.held_out > 0 || m.study.evaluate.leave_out > 0 || m.method.num_rollouts > 0;
  if (!m.study.target.recording || any_left_out || m.data.target.num_rollouts() < 2) return "";
  return "there are none, so nothing shows whether it is too sure because the simulator lacks "
         "something; set target.held_out = 1 with target.num_rollouts for the others, or "
         "evaluate.leave_out = 2";
}

// The same of the noise of recorded first states, in which simulations begin; "" where each device
// began at rest or they are inferred, and what mends it is for Gaussian noise alone.
std::string why_not_first_states(const MethodResults& m) {
  const ObservationNoise& noise = m.study.observation_noise;
  const bool begins_in_motion =
      m.study.simulator.segment_length > 0 ||
      !std::ranges::all_of(m.data.target.rollouts, analysis::begins_at_rest);
  const bool is_refined = m.is(inference::Algorithm::refine) && !m.method.refine.infer_first_states;
  if (!m.study.target.recording || !(learns(m.method) || is_refined) || noise.is_silent() ||
      noise.is_heavy_tailed() || !begins_in_motion) {
    return "";
  }
  return "simulations begin in recorded ones as if these were exact, and parameters may make up "
         "for the noise that they have; unless the device began at rest, compare with a refinement "
         "that has refine.infer_first_states = true";
}

// The same of calibration, which costs more than some studies spend on inference; "" of methods
// without a network, and where the study itself has chosen checks that are made.
std::string why_not_calibrated(const MethodResults& m) {
  const Study& study = m.study;
  const bool is_left_out = study.diagnose.calibrates() && !study.source().simulates;
  if (study.places.has("diagnose.checks") && !is_left_out) return "";
  const bool has_network = family_of(m.method) == inference::AlgorithmFamily::network;
  if (!study.source().simulates && has_network) {
    return "a dataset can't be asked for other simulations, so nothing shows whether "
           "posteriors are too sure, or too unsure; keep rows back, and see where their parameters "
           "lie in what npdr sample --x draws for them";
  }
  if (has_network && m.method.algorithm.num_rounds > 1) {
    return "of several rounds only the network of round 1 can be calibrated, which isn't the "
           "result; held-out rollouts, or a refinement that starts from the result, tell whether "
           "that is too sure";
  }
  const bool could_be = traits_of(Check::coverage).why_unchecked(study, m.method).empty();
  if (!could_be || m.checks.calibrates()) return "";
  return fmt::format(
      "it wasn't checked, so nothing shows whether posteriors are too sure, or too "
      "unsure, over the prior; a table [diagnose] in the study checks it: for each seed {} more "
      "are simulated, and a posterior is sampled for each",
      study.diagnose.num_simulations);
}

// What no check looked at, of a method that passes all, and why.
void add_unchecked(const MethodResults& m, CheckSummary& summary) {
  const auto add = [&](std::string_view title, const std::string& why_not) {
    if (why_not.empty()) return;
    summary.unchecked.emplace_back(title);
    summary.reasons.push_back(fmt::format("{}: {}", title, why_not));
  };
  add(traits_of(Check::held_out).title, why_not_held_out(m));
  add("Calibration", why_not_calibrated(m));
  add("First states", why_not_first_states(m));
}

Findings findings_of(const MethodResults& m) {
  Findings findings;
  for (const Check check : values_of<Check>()) {
    if (m.checks.has(check)) findings.push_back(judge(check, m));
  }
  // The first that fails of those which a wrong simulator makes fail says where.
  const auto says_where = [](const Finding& found) {
    using enum Check;
    constexpr std::array told_by = {predictive, residuals, fit, held_out};
    return found.severity == Severity::wrong &&
           std::ranges::any_of(told_by, [&](Check check) { return found.id == name_of(check); });
  };
  const auto first = std::ranges::find_if(findings, says_where);
  if (first != findings.end()) first->what += where_wrong(m.data);
  return findings;
}

}  // namespace

Findings findings_of(const ReportData& data, const std::string& method) {
  return findings_of(MethodResults(data, method));
}

std::vector<CheckSummary> check_summaries(const ReportData& data) {
  std::vector<CheckSummary> summaries;
  for (const std::string& method : data.methods) {
    const MethodResults m(data, method);
    const Findings findings = findings_of(m);
    if (findings.empty()) continue;
    const auto is_verdict = [&](const Finding& finding) {
      return m.is_of_result(*value_named<Check>(finding.id));
    };
    CheckSummary summary{method, std::ranges::count_if(findings, is_verdict), {}, {}, {}, {}};
    for (const auto& [id, severity, where, what, evidence] : findings) {
      if (severity == Severity::wrong) summary.failed.push_back(where);
      if (severity == Severity::unknown) summary.unknown.push_back(where);
      if (!what.empty()) summary.reasons.push_back(where + ": " + what);
    }
    if (summary.failed.empty() && summary.unknown.empty()) add_unchecked(m, summary);
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

}  // namespace npdr::pipeline
