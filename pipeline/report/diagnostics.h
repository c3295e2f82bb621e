/// What a report says of the checks of its posteriors.
#pragma once

#include <filesystem>
#include <optional>

#include "analysis/report.h"
#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// One row a check, one column a method. A check fails below alpha over the number of checks and
/// seeds of the method.
analysis::Table diagnostics_table(const ReportData& data);

/// The table and the figures of the first seed; nothing for a study without checks.
std::optional<analysis::ReportSection> diagnostics_section(const ReportData& data,
                                                           const std::filesystem::path& folder);

}  // namespace npdr::pipeline
