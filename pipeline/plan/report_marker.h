/// Whether a study's report belongs to a plan: report.json in the study's folder holds its key.
#pragma once

#include <optional>

#include "core/finding.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// What the checks say of one method's posteriors.
struct CheckSummary {
  std::string method;
  Index num_checks = 0;
  std::vector<std::string> failed = {};     ///< titles of the checks
  std::vector<std::string> unknown = {};    ///< of those that can't tell
  std::vector<std::string> unchecked = {};  ///< what no check looked at, where all pass
  Findings reasons = {};                    ///< `where`: the check's title; the worst first
};

/// "NPE: 2 of 7 checks FAIL: Training, RMSE"; "NPE: all 7 checks pass; not checked: Calibration".
std::string words_of(const CheckSummary& summary);

/// "Don't trust the error bars.", of what the checks that fail refute, then of those that can't
/// tell; "" where there are none.
std::string trust_of(const CheckSummary& summary);

/// The key is the plan's, this build made the report, whose verdicts another one may find
/// otherwise, and all files of it are there.
bool report_is_current(const Plan& plan, const Node& node);
/// `study`: the file that it was made of; `files`: of the report, besides report.html; below the
/// study's folder. Throws Error.
void mark_report(const Node& node, const std::filesystem::path& study,
                 const std::vector<std::filesystem::path>& files,
                 const std::vector<CheckSummary>& checks);
/// The verdicts of a report that is current. Throws InputError where it can't be read.
std::vector<CheckSummary> read_check_summaries(const Node& node);
/// What the report that is there says of `method`, where it is of all that `plan` selects, and
/// maybe of more; nothing else, or where it can't be read.
std::optional<CheckSummary> reported_checks(const Plan& plan, const std::string& method);

/// A warning where the report that is there is another one than the plan's and was made of a file
/// with another name, whose study has the same name as the plan's. Files of the same name
/// in other folders pass for one.
Findings find_replaced_report(const Plan& plan);

/// <work>/<study>/report.html
std::filesystem::path report_path(const Plan& plan);

}  // namespace npdr::pipeline
