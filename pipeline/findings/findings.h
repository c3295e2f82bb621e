/// What is found of a study's posteriors.
#pragma once

#include "core/finding.h"
#include "pipeline/config/check.h"
#include "pipeline/findings/data.h"
#include "pipeline/plan/report_marker.h"

namespace npdr::pipeline {

/// Of each check its verdict, then remarks, in the order of checks; those that mean nothing to the
/// method are left out. `id`: the check's name, or "fit.floor" of a part; `where`: its title.
/// Without `what` and `advice` where another finding says why.
Findings findings_of(const ReportData& data, const std::string& method);

/// The check that found it.
Check check_of(const Finding& finding);

/// All verdicts of a study, a method each. Reasons: the worst first, and causes before others.
std::vector<CheckSummary> check_summaries(const ReportData& data);

/// Contraction, which says how much narrower than the prior a posterior is in parameter d, for each
/// run of a method, in the order of seeds:
///   1 - Var(theta_d | x_o) / Var(theta_d),
/// both variances around the circular mean for a periodic parameter, and of logarithms for one over
/// decades: its variance would be that of its largest values.
Vector contraction(const ReportData& data, const std::string& method, Index d);

/// An end of a prior that samples press against.
struct PressedBound {
  double value = 0.0;
  bool is_lower = false;
  bool leaks = false;  ///< samples lie where hardly any of the prior's do
  double share = 0.0;  ///< of the samples, within a quarter of their width from there
};

/// Those of a marginal that samples of it (n) press against (bound_pressure.h), the lower one
/// first; none of a marginal without. Throws InputError for fewer than kFewestForBounds.
std::vector<PressedBound> pressed_bounds(const inference::Marginal& marginal,
                                         const Vector& samples);

}  // namespace npdr::pipeline
