#include "pipeline/apps/verdict_lines.h"

#include "pipeline/apps/command_line.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/process/fitted_text.h"

namespace npdr::pipeline {
namespace {

// A terminal would break the line within a word.
void print_prose(const std::string& text) {
  const auto columns = terminal_columns();
  const std::string line = printable_line(text);
  fmt::print("{}\n", columns ? wrapped(line, *columns) : line);
}

}  // namespace

bool print_verdicts(const Plan& plan, VerdictDetail detail) {
  const bool has_reasons = detail == VerdictDetail::reasons;
  const char* const gap = has_reasons ? "\n" : "";  // between methods
  bool any_failed = false;
  fmt::print("{}", has_reasons ? "" : "\n");
  for (const CheckSummary& summary : read_check_summaries(plan.nodes.back())) {
    fmt::print("{}", gap);
    print_prose(words_of(summary));
    any_failed = any_failed || !summary.failed.empty();
    if (!has_reasons) continue;
    for (const std::string& reason : summary.reasons) print_prose("  " + reason);
  }
  fmt::print("{}", gap);
  print_line("report: {}", report_path(plan).string());
  return any_failed;
}

void print_verdicts_if_made(const Plan& plan) {
  if (report_is_current(plan, plan.nodes.back())) print_verdicts(plan, VerdictDetail::line);
}

void warn_of_failed_checks(const Plan& plan, const std::string& method) {
  const std::optional<CheckSummary> checks = reported_checks(plan, method);
  if (!checks && !plan.study.diagnose_of(plan.study.method(method)).checks.empty()) {
    fmt::print(stderr, "note: no report says whether the checks of {} pass; make it: {}\n",
               printable_line(method), printable_line(plan.command()));
  }
  if (!checks || checks->failed.empty()) return;
  print_warning(printable_line(words_of(*checks) +
                               "; what was found and what to do: " + report_path(plan).string()));
}

}  // namespace npdr::pipeline
