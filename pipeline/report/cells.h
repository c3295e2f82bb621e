/// What the tables of a report have in common.
#pragma once

#include <string>

#include "analysis/summary.h"
#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// What people call a metric: "RMSE, held out".
std::string title_of(const ReportData& data, const std::string& metric);

/// Mean and standard deviation; a footnote of `table` says how many samples failed.
analysis::Cell cell_of(analysis::Table& table, const analysis::Summary& summary);

/// Adds a column for each round that any method has; returns how many.
Index add_round_columns(analysis::Table& table, const ReportData& data);

}  // namespace npdr::pipeline
