/// Policy test artefacts: what a policy does in the target domain, and where it still works.
///
///   policy (Q) float64; initial_states (n, C)
///   target/return (n), target/success (n) 1 or 0: in the simulated target domain, a rollout from
///   each initial state; only for a study with a truth
///   grid/return (X, Y, n), grid/success (X, Y, n): at each point of the grid, where the study has
///   one; NaN where the domain parameters are impossible; attributes x_parameter, x_values,
///   y_parameter, y_values
///   attribute of the file: success_means, in words
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

void write_policy_test(h5::File& file, const Study& study, const sim::PolicyTaskInfo& info,
                       const PolicyTest& test);
/// Throws InputError.
PolicyTest read_policy_test(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
