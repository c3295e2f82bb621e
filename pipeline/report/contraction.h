/// Contraction, which says how much narrower than the prior a posterior is:
///   1 - Var(theta_d | x_o) / Var(theta_d),
/// both variances around the circular mean for a periodic parameter.
#pragma once

#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Deviation of parameter d under the prior.
double prior_deviation(const ReportData& data, Index d);

/// Contraction of a run's samples in parameter d, whose deviation under the prior is given.
double contraction(const ReportData& data, const EvaluatedRun& run, Index d, double prior_std);

}  // namespace npdr::pipeline
