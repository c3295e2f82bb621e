/// What a report says of the policies that were searched for.
#pragma once

#include <filesystem>
#include <optional>

#include "analysis/report.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Names of the tables that policy_section() makes. "policy_cost" holds times, so that two runs
/// that computed the same differ in it.
inline constexpr const char* kPolicyTables[] = {"policy", "policy_seeds", "policy_parameters",
                                                "policy_cost"};

/// Tables of returns and successes before and after the search, of each experiment, of the policies
/// that were found, and of what they took; learning curves, and maps over the grid. Nothing without
/// [policy].
std::optional<analysis::ReportSection> policy_section(const ReportData& data,
                                                      const std::filesystem::path& folder);

}  // namespace npdr::pipeline
