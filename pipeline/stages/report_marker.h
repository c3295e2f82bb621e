/// Whether a study's report belongs to a plan: report.json in the study's folder holds its key.
#pragma once

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

bool report_is_current(const Plan& plan, const Node& node);
void mark_report(const Plan& plan, const Node& node);
/// Takes the mark away, where there is one.
void unmark_report(const Node& node);

/// <work>/<study>/report.html
std::filesystem::path report_path(const Plan& plan);

}  // namespace npdr::pipeline
