#include "pipeline/findings/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <utility>

#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// A finding that explains others, which then aren't said.
struct Cause {
  std::string_view id;  // of the finding, or of a check with all of its parts
  std::array<std::optional<Check>, 8> consequences;

  bool is(const Finding& finding) const {
    return finding.severity == Severity::wrong &&
           (finding.id == id || finding.id.starts_with(std::string(id) + "."));
  }
};

// Causes of causes come first, with all that these explain.
constexpr auto causes() {
  using enum Check;
  return std::to_array<Cause>(
      {{"fit.cause", {ood, predictive, width, residuals, held_out, contraction, sampling}},
       {"ood", {predictive, width, fit, residuals, held_out, contraction, sampling, bounds}},
       {"dataset", {predictive, width, fit, residuals, held_out, contraction, sampling, bounds}},
       {"fit.floor", {residuals, predictive, width, held_out, bounds}},
       {"fit.misfit", {residuals, predictive, width, held_out, bounds}},
       {"training.unfinished", {sbc, coverage, tarp, local_c2st, predictive, width}}});
}
constexpr auto kCauses = causes();

bool is_cause(const Finding& finding) {
  return std::ranges::any_of(kCauses, [&](const Cause& cause) { return cause.is(finding); });
}

void add_new(std::vector<std::string>& titles, const std::string& title) {
  if (std::ranges::count(titles, title) == 0) titles.push_back(title);
}

// Takes their words from the consequences of a cause, which names those that fail.
void explain(const Cause& cause, Findings& findings) {
  const auto is_said = [&](const Finding& found) { return cause.is(found) && !found.what.empty(); };
  const auto first = std::ranges::find_if(findings, is_said);
  if (first == findings.end()) return;
  std::vector<std::string> same;
  for (Finding& finding : findings) {
    const bool follows = std::ranges::count(cause.consequences, check_of(finding)) > 0;
    if (!follows || finding.severity == Severity::unknown || finding.what.empty()) continue;
    if (finding.severity == Severity::wrong) add_new(same, finding.where);
    finding.what.clear();
    finding.advice.clear();
  }
  if (same.empty()) return;
  first->what +=
      fmt::format(". {} {} for the same reason", listed(same), same.size() == 1 ? "fails" : "fail");
}

// Why no check of a method looks at what held-out rollouts would show; without words: one does, or
// needn't.
Finding why_not_held_out(const MethodResults& m) {
  const bool any_left_out =
      m.study.target.held_out > 0 || m.study.evaluate.leave_out > 0 || m.method.num_rollouts > 0;
  if (!m.study.target.recording || any_left_out || m.data.target.num_rollouts() < 2) return {};
  return {.what = "nothing shows whether predictions of other rollouts are right",
          .advice = "Set leave_out = 2 in [evaluate]"};
}

// The same of the noise of recorded first states, in which simulations begin; none where each
// device began at rest or they are inferred, and what mends it is for Gaussian noise alone.
Finding why_not_first_states(const MethodResults& m) {
  const ObservationNoise& noise = m.study.observation_noise;
  const bool takes_them_as_exact =
      (learns(m.method) || m.is(inference::Algorithm::refine)) && !infers_first_states(m);
  if (!takes_them_as_exact || noise.is_silent() || noise.is_heavy_tailed() ||
      !begins_in_motion(m)) {
    return {};
  }
  return {.what = "simulations begin in noisy recorded states as if these were exact",
          .advice = "Compare with a refinement that has infer_first_states = true"};
}

// The same of calibration, which costs more than some studies spend on inference; none of methods
// without a network, and where the study itself has chosen checks that are made.
Finding why_not_calibrated(const MethodResults& m) {
  const Study& study = m.study;
  const bool is_left_out = study.diagnose.calibrates() && !study.source().simulates;
  if (study.places.has("diagnose.checks") && !is_left_out) return {};
  const bool has_network = family_of(m.method) == inference::AlgorithmFamily::network;
  if (!study.source().simulates && has_network) {
    return {.what = "a dataset can't show whether the error bars are right",
            .advice = "Keep rows back, and compare their parameters with npdr sample --x"};
  }
  if (has_network && m.method.algorithm.num_rounds > 1) {
    return {.what = "after several rounds nothing shows whether the error bars are right",
            .advice = "Compare with a refinement that starts from this method"};
  }
  const bool could_be = traits_of(Check::coverage).why_unchecked(study, m.method).empty();
  if (!could_be || m.checks.calibrates()) return {};
  return {.what = "nothing shows whether the error bars are right over the prior",
          .evidence = fmt::format("{} more simulations of each seed would show it",
                                  study.diagnose.num_simulations),
          .advice = "Add an empty table [diagnose] to the study"};
}

// What no check looked at, of a method that passes all, and why.
void add_unchecked(const MethodResults& m, CheckSummary& summary) {
  const auto add = [&](std::string_view title, Finding why_not) {
    if (why_not.what.empty()) return;
    summary.unchecked.emplace_back(title);
    why_not.id = "unchecked";
    why_not.where = title;
    summary.reasons.push_back(passes(std::move(why_not)));
  };
  add(traits_of(Check::held_out).title, why_not_held_out(m));
  add("Calibration", why_not_calibrated(m));
  add("First states", why_not_first_states(m));
}

Findings findings_of(const MethodResults& m) {
  Findings findings;
  for (const Check check : values_of<Check>()) {
    if (m.checks.has(check)) append(findings, judge(check, m));
  }
  for (const Cause& cause : kCauses) explain(cause, findings);
  return findings;
}

}  // namespace

Check check_of(const Finding& finding) {
  return *value_named<Check>(finding.id.substr(0, finding.id.find('.')));
}

Findings findings_of(const ReportData& data, const std::string& method) {
  return findings_of(MethodResults(data, method));
}

std::vector<CheckSummary> check_summaries(const ReportData& data) {
  std::vector<CheckSummary> summaries;
  for (const std::string& method : data.methods) {
    const MethodResults m(data, method);
    Findings findings = findings_of(m);
    if (findings.empty()) continue;
    const Index num_checks = std::ranges::count_if(values_of<Check>(), [&](Check check) {
      return m.checks.has(check) && m.is_of_result(check);
    });
    CheckSummary summary{.method = method, .num_checks = num_checks};
    for (const Finding& finding : findings) {
      if (finding.severity == Severity::wrong) add_new(summary.failed, finding.where);
      if (finding.severity == Severity::unknown) add_new(summary.unknown, finding.where);
    }
    std::erase_if(findings, [](const Finding& finding) { return finding.what.empty(); });
    std::ranges::stable_sort(findings, std::greater(), [](const Finding& finding) {
      return std::pair(finding.severity, is_cause(finding));
    });
    summary.reasons = std::move(findings);
    if (summary.failed.empty() && summary.unknown.empty()) add_unchecked(m, summary);
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

}  // namespace npdr::pipeline
