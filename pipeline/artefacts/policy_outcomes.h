/// Policy test artefacts: what a policy does in the target domain, and where it still works.
#pragma once

#include <optional>

#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {

/// Rollouts of one policy, from n initial states each.
struct PolicyOutcomes {
  RowMatrix returns;  ///< (rows, n)
  RowMatrix success;  ///< (rows, n) 1 or 0
};

struct PolicyTest {
  Vector policy;                         ///< (Q)
  RowMatrix initial_states;              ///< (n, C)
  std::optional<PolicyOutcomes> target;  ///< one row
  std::optional<PolicyOutcomes> grid;    ///< X Y rows: row (x Y + y) is point (x, y)
  // Words and columns of the file; of these only what a success means is read.
  sim::PolicyTaskInfo info = {};
  std::vector<Channel> states = {};
  PolicyGrid axes = {};
};
void describe(Layout f, PolicyTest& test);

}  // namespace npdr::pipeline
