/// The report of a study: tables, figures, report.html.
#pragma once

#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Makes the artefact of the stage 'report' from all evaluations and checks. Throws InputError for
/// a damaged artefact, FailedRolloutsError when more rollouts failed than the study allows, Error
/// when a figure can't be drawn or writing fails.
void run_report(const Plan& plan, const Node& node);

/// Lines to copy: paths of the posteriors with their verdicts, and commands that sample and read
/// the posterior of which the fewest checks fail.
std::string next_steps(const ReportData& data);

/// Explanation of the posteriors of "npe_nle", the default algorithm; "" without any.
std::string pooling_text(const Study& study);

}  // namespace npdr::pipeline
