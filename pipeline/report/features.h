/// The table of what posteriors predict for each feature of x.
#pragma once

#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// One row a feature and method: x_o, mean and standard deviation, 5, 50 and 95 % of the posterior
/// predictive distribution, and the probability of its lower tail at x_o (Gelman et al. 1996),
/// pooled over seeds. Only for studies whose simulator is a command.
analysis::Table features_table(const ReportData& data, const Target& target);

}  // namespace npdr::pipeline
