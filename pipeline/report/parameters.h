/// Tables of a report with a row for each domain parameter.
#pragma once

#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Prior, baselines and posteriors: mean and deviation, circular for a periodic parameter.
analysis::Table parameters_table(const ReportData& data);

/// How much narrower than the prior each posterior is:
///   1 - Var(theta_d | x_o) / Var(theta_d),
/// both variances around the circular mean for a periodic parameter.
analysis::Table contraction_table(const ReportData& data);

}  // namespace npdr::pipeline
