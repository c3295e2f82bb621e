/// Contraction, which says how much narrower than the prior a posterior is:
///   1 - Var(theta_d | x_o) / Var(theta_d),
/// both variances around the circular mean for a periodic parameter, and of logarithms for one over
/// decades: its variance would be that of its largest values.
#pragma once

#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Deviation of parameter d under the prior.
double prior_deviation(const ReportData& data, Index d);

/// Contraction of a run's samples in parameter d, whose deviation under the prior is given.
double contraction(const ReportData& data, const EvaluatedRun& run, Index d, double prior_std);

/// Kolmogorov-Smirnov distance of a run's samples in parameter d from the prior: near 1 / sqrt(n)
/// where they are n draws of it. It sees what no variance does: modes, a shift.
double distance_from_prior(const ReportData& data, const EvaluatedRun& run, Index d);

}  // namespace npdr::pipeline
