/// The report of a study: tables, figures, report.html. run<Stage::report>() (plan.h) makes them
/// from all evaluations and checks. It throws InputError for a damaged artefact,
/// FailedRolloutsError when more rollouts failed than the study allows, Error when a figure can't
/// be drawn or writing fails.
#pragma once

#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Lines to copy: paths of the posteriors with their verdicts, and commands that sample and read
/// the posterior of which the fewest checks fail.
std::string next_steps(const ReportData& data);

/// Explanation of the posteriors of "npe_nle", the default algorithm; "" without any.
std::string pooling_text(const Study& study);

}  // namespace npdr::pipeline
