#include "pipeline/apps/verdict_lines.h"

#include "pipeline/apps/command_line.h"
#include "pipeline/plan/report_marker.h"

namespace npdr::pipeline {

bool print_verdicts(const Plan& plan, VerdictDetail detail) {
  const bool has_reasons = detail == VerdictDetail::reasons;
  const char* const gap = has_reasons ? "\n" : "";  // between methods
  bool any_failed = false;
  fmt::print("{}", has_reasons ? "" : "\n");
  for (const CheckSummary& summary : read_check_summaries(plan.nodes.back())) {
    fmt::print("{}", gap);
    print_line("{}", words_of(summary));
    any_failed = any_failed || !summary.failed.empty();
    if (!has_reasons) continue;
    for (const std::string& reason : summary.reasons) print_line("  {}", reason);
  }
  fmt::print("{}", gap);
  print_line("report: {}", report_path(plan).string());
  return any_failed;
}

void print_verdicts_if_made(const Plan& plan) {
  if (report_is_current(plan, plan.nodes.back())) print_verdicts(plan, VerdictDetail::line);
}

}  // namespace npdr::pipeline
