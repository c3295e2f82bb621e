/// Whether a study's report belongs to a plan: report.json in the study's folder holds its key.
#pragma once

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// The key is the plan's, and all files of the report are there.
bool report_is_current(const Plan& plan, const Node& node);
/// `files`: of the report, besides report.html; below the study's folder. Throws Error.
void mark_report(const Node& node, const std::vector<std::filesystem::path>& files);
/// Takes the mark away, where there is one. Throws std::filesystem::filesystem_error.
void unmark_report(const Node& node);

/// <work>/<study>/report.html
std::filesystem::path report_path(const Plan& plan);

}  // namespace npdr::pipeline
