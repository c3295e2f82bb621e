/// Policy artefacts: what a search has found, and how it got there. A checkpoint holds the same for
/// the iterations that are done, the state of the optimizer and the cost so far. A test artefact
/// says what a policy does in the target domain, and where it still works.
#pragma once

#include <optional>

#include "inference/policy_search/policy_optimizer.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study.h"
#include "sim/policy_evaluation.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {

/// Outcomes of the policies of a search, a row each.
struct PolicyHistory {
  RowMatrix policies;          ///< (t, Q)
  Vector mean_return;          ///< (t)
  Vector success_rate;         ///< (t)
  Vector completion_rate;      ///< (t) share of the rollouts that kept the task's limits
  RowMatrix candidate_return;  ///< (t, M), or (t - 1, M) when the search is over
  Index num_rollouts = 0;      ///< of all candidates, and of these policies
  Index num_impossible = 0;    ///< domain parameters that were left out: physically impossible

  Index num_rows() const { return policies.rows(); }
  /// Adds a policy and what is known of it: row `i` of `values`.
  void add(const Vector& policy, const sim::PopulationValues& values, Index i);
  void add_candidates(const Vector& returns);
};

inline constexpr Dim kPolicyParameter{"Q", "parameter"};
/// Names and units of a policy's parameters.
std::vector<Channel> policy_columns(const sim::PolicyTaskInfo& info);

/// What a search has found.
struct FoundPolicy {
  std::string optimizer;                 ///< its name
  PolicyHistory history;                 ///< ends with `policy`
  Vector policy = {};                    ///< (Q); follows from the history when it is written
  std::vector<Channel> parameters = {};  ///< of the policy; not read
};
void describe(Layout f, FoundPolicy& found);

/// State that an interrupted search goes on from.
struct PolicyCheckpoint {
  PolicyHistory history;
  inference::PolicySearchState optimizer;
  Cost cost;
};
void describe(Layout f, PolicyCheckpoint& checkpoint);

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
