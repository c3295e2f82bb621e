/// Rows for the tests of closed loops.
#pragma once

#include <memory>
#include <string>

#include "core/random.h"
#include "sim/policy_task.h"
#include "sim/simulator.h"

namespace npdr::sim {

struct PolicyRows {
  RowMatrix theta;           // (n, P)
  RowMatrix initial_states;  // (n, S)
  RowMatrix policies;        // (n, Q)
};

inline std::unique_ptr<PolicyTask> swing_up(Index num_steps = 0,
                                            Integrator integrator = Integrator::erk4,
                                            Index substeps = 1) {
  return make_policy_task({.name = "furuta", .integrator = integrator, .substeps = substeps},
                          {.num_steps = num_steps});
}

/// Domain parameters of the extended study and policies around the initial one, all different.
inline PolicyRows random_rows(Index count, std::uint64_t seed = 1) {
  const auto task = swing_up();
  const auto simulator = make_simulator({.name = "furuta"});
  PolicyRows rows;
  rows.theta = complete_theta(*simulator, {}).transpose().replicate(count, 1);
  rows.initial_states = task->initial_states(count, {seed, "initial"});
  rows.policies = initial_policy(task->info()).transpose().replicate(count, 1);
  for (Index i = 0; i < count; ++i) {
    Stream stream({seed, "policy_rows", 0, static_cast<std::uint64_t>(i), 0});
    for (Index p = 0; p < 9; ++p) rows.theta(i, p) *= 0.9 + 0.2 * stream.uniform();
    rows.theta.row(i).tail(6) << -0.2 * stream.uniform(), 0.2 * stream.uniform(),
        3.0 * stream.uniform(), 5e-4 * stream.uniform(), 1e-3 * stream.uniform(),
        0.6 * stream.uniform() - 0.3;
    for (double& gain : rows.policies.row(i)) gain *= 0.9 + 0.2 * stream.uniform();
  }
  return rows;
}

inline PolicyRollouts run(const PolicyTask& task, const PolicyRows& rows) {
  return task.run(rows.theta, rows.initial_states, rows.policies);
}

inline RecordedPolicyRollouts record(const PolicyTask& task, const PolicyRows& rows) {
  return task.record(rows.theta, rows.initial_states, rows.policies);
}

}  // namespace npdr::sim
