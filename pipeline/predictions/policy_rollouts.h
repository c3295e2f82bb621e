/// Rollouts of policies: the closed-loop task of a study, domain parameters that policies are
/// tested on, and rollouts collected under a policy.
#pragma once

#include <memory>

#include "pipeline/plan/plan.h"
#include "pipeline/sources/source.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {

/// `num_steps`: of a rollout; 0: as the study says.
std::unique_ptr<sim::PolicyTask> make_task(const Study& study, Index num_steps = 0);

/// The policy (Q) that the study's first search begins with.
Vector first_policy(const Study& study, const sim::PolicyTaskInfo& info);

/// Domain parameters that policies are tested on, a row of complete ones (P) each: the target
/// domain, where it is simulated; then the points of the grid, y fastest. Those not on the grid are
/// as in the target domain, or nominal where that one is recorded.
RowMatrix tested_parameters(const Study& study, const Source& source);

/// `count` rollouts of `policy` (Q) in the simulated target domain, as long as those of `like` and
/// in its channels. When a state leaves the task's limits, the policy is switched off: zero actions
/// follow, and the recording goes on to its end. Initial states are named by `id`. Throws Error
/// when a rollout diverges.
Target collect_rollouts(const Plan& plan, const Target& like, const Vector& policy, Index count,
                        const StreamId& id);

}  // namespace npdr::pipeline
