/// Verdicts of the checks that a study's posteriors are put to: what each says of a method, over
/// its seeds.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/report_marker.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// What a check says. `unknown`: it has too little to find what it looks for.
enum class Judgment { passes, fails, unknown };

struct Verdict {
  Check check;
  Judgment judgment = Judgment::passes;
  std::string text;    ///< in a few words, with its number: "passes, p = 0.4"
  std::string reason;  ///< what was found and what to do; empty where there is nothing to do
};

/// The verdicts on a method, in the order of checks; those that mean nothing to it are left out.
std::vector<Verdict> verdicts_of(const ReportData& data, const std::string& method);

/// The same of one check of evaluated samples.
Verdict judge_sampling(const ReportData& data, const std::string& method);
Verdict judge_residuals(const ReportData& data, const std::string& method);
Verdict judge_bounds(const ReportData& data, const std::string& method);
Verdict judge_contraction(const ReportData& data, const std::string& method);
Verdict judge_fit(const ReportData& data, const std::string& method);
Verdict judge_held_out(const ReportData& data, const std::string& method);

/// R-hat (chain_diagnostics.h) above which chains count as having found different places.
inline constexpr double kLargestRHat = 1.1;

/// " in 2 of 5 seeds"; nothing where there is one.
std::string seeds_text(std::size_t failed, std::size_t all);

/// All verdicts of a study, a method each.
std::vector<CheckSummary> check_summaries(const ReportData& data);

}  // namespace npdr::pipeline
