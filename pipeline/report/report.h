/// The report of a study: tables, figures, report.html.
#pragma once

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Makes the artefact of the stage 'report' from all evaluations and checks. Throws InputError for
/// a damaged artefact, FailedRolloutsError when more rollouts failed than the study allows, Error
/// when a figure can't be drawn or writing fails.
void run_report(const Plan& plan, const Node& node);

}  // namespace npdr::pipeline
