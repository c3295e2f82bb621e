/// Pieces that the tables and figures of policies share.
#pragma once

#include <string>
#include <vector>

#include "pipeline/findings/data.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {

/// Returns or successes of a test.
using Outcome = RowMatrix PolicyOutcomes::*;
/// Of a policy: none, or all of them.
enum class Searches { before, after };

/// Tests of a method in the order of seeds: before any search, or after the last.
std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        Searches searches);

/// Searches of a method and seed, by iteration.
std::vector<const PolicyHistory*> histories_of(const ReportData& data, const std::string& method,
                                               std::uint64_t seed);

sim::PolicyTaskInfo task_info(const ReportData& data);

/// The text above the tables of policies.
std::string policy_prose(const ReportData& data);

}  // namespace npdr::pipeline
