/// What the checks of a study say, on the terminal.
#pragma once

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// How much is said of a method: its verdict, or also why checks failed and what to do.
enum class VerdictDetail { line, reasons };

/// Prints the verdicts of a study whose report is current, and where that lies. Returns whether any
/// check failed. Throws as read_check_summaries().
bool print_verdicts(const Plan& plan, VerdictDetail detail);

/// One line a method, where the report is current; nothing else. Throws as read_check_summaries().
void print_verdicts_if_made(const Plan& plan);

/// Warns on stderr where the report (reported_checks()) says that `method` fails checks, and notes
/// where there are some, but no report of them.
void warn_of_failed_checks(const Plan& plan, const std::string& method);

}  // namespace npdr::pipeline
