/// Pieces that the tables and figures of policies share.
#pragma once

#include <string>
#include <vector>

#include "pipeline/findings/data.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {

/// Returns or successes of a test.
using Outcome = RowMatrix PolicyOutcomes::*;
/// In the target domain or on the grid.
using TestPlace = std::optional<PolicyOutcomes> PolicyTest::*;

bool is_tested_in_target(const ReportData& data);
bool is_tested_on_grid(const ReportData& data);

/// Tests of a method in the order of seeds: before any search, or after the last.
std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        bool is_before);

/// One outcome of all rollouts of a test, to pool.
inline auto outcome_samples(TestPlace place, Outcome outcome) {
  return [=](const PolicyTest* test) -> Vector {
    return ((*(test->*place)).*outcome).reshaped<Eigen::RowMajor>();
  };
}

/// The last history of a method and seed.
const PolicyHistory& last_history(const ReportData& data, const std::string& method,
                                  std::uint64_t seed);

sim::PolicyTaskInfo task_info(const ReportData& data);

/// True when an experiment uses an artefact, for other things than calibration.
bool is_used_by(const Node& node, const std::string& method, std::uint64_t seed);

/// The text above the tables of policies.
std::string policy_prose(const ReportData& data);

}  // namespace npdr::pipeline
