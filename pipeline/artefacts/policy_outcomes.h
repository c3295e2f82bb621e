/// Policy test artefacts: what a policy does in the target domain, and where it still works.
#pragma once

#include <optional>

#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"
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
};

/// Throws Error.
void write_policy_test(h5::File& file, const Study& study, const sim::PolicyTaskInfo& info,
                       PolicyTest test);
/// Throws InputError.
PolicyTest read_policy_test(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
