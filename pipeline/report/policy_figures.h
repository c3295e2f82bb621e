/// The figures of a report's section about policies.
#pragma once

#include <filesystem>
#include <vector>

#include "analysis/report.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Learning curves; where the study has a grid, maps of the return and of successes over it.
std::vector<analysis::ReportFigure> policy_figures(const ReportData& data,
                                                   const std::filesystem::path& folder);

}  // namespace npdr::pipeline
