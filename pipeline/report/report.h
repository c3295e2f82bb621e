/// The report of a study: tables, figures, report.html.
#pragma once

#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Makes the artefact of the stage 'report' from all evaluations and checks. Throws InputError for
/// a damaged artefact, FailedRolloutsError when more rollouts failed than the study allows, Error
/// when a figure can't be drawn or writing fails.
void run_report(const Plan& plan, const Node& node);

/// Lines to copy: where the posteriors are, with what their checks say, and commands that sample
/// and read that of which the fewest checks fail.
std::string next_steps(const ReportData& data);

/// What posteriors are that two kinds of networks make together, for people who didn't choose them,
/// since they are the default; "" without any.
std::string pooling_text(const Study& study);

}  // namespace npdr::pipeline
