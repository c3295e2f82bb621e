/// Pieces that the tables and figures of policies share.
#pragma once

#include <string>
#include <vector>

#include "pipeline/findings/data.h"
#include "pipeline/report/table_of.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {

/// Returns or successes of a test.
using Outcome = RowMatrix PolicyOutcomes::*;
/// In the target domain or on the grid.
using TestPlace = std::optional<PolicyOutcomes> PolicyTest::*;
/// Of a policy: none, or all of them.
enum class Searches { before, after };

bool is_tested_in_target(const ReportData& data);
bool is_tested_on_grid(const ReportData& data);
/// In either.
bool is_tested(const ReportData& data);

/// Tests of a method in the order of seeds: before any search, or after the last.
std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        Searches searches);

/// One outcome of all rollouts of a test, to pool.
inline auto outcome_samples(TestPlace place, Outcome outcome) {
  return [=](const PolicyTest* test) -> Vector {
    return ((*(test->*place)).*outcome).reshaped<Eigen::RowMajor>();
  };
}

/// Searches of a method and seed, by iteration.
std::vector<const PolicyHistory*> histories_of(const ReportData& data, const std::string& method,
                                               std::uint64_t seed);

/// A row for each method that has searched for a policy.
TableOf<std::string> table_of_policy_methods(const ReportData& data, std::string caption);

sim::PolicyTaskInfo task_info(const ReportData& data);

/// Nodes of some stages that an experiment uses, for other things than calibration.
std::vector<const Node*> nodes_of(const ReportData& data, const std::string& method,
                                  std::uint64_t seed, const std::vector<Stage>& stages);

/// The text above the tables of policies.
std::string policy_prose(const ReportData& data);

}  // namespace npdr::pipeline
