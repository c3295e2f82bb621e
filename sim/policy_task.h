/// The closed-loop task of a simulator: rollouts in which a policy picks the actions, and rewards.
///
/// With domain parameters theta (P), initial state s_0 (S) and policy parameters phi (Q), step t is
///   u_t = pi(s_t; phi)   the action that the policy commands,
///   a_t = clip(u_t)      what the actuator is given, held over the step,
///   r_t = r(s_t, u_t)    the reward, in [0, 1],
///   s_{t+1}              by the simulator's own dynamics, those that replay recordings.
/// The return of a rollout is sum_t r_t over its T steps (no discount). A rollout ends early once a
/// state leaves the task's limits or isn't finite, or an action isn't a number; what would have
/// come afterward counts 0, so that a failure is never worth more than staying within the limits.
///
/// The search for policies acts on other coordinates: log phi of parameters that are positive, phi
/// of the others.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/target.h"
#include "core/types.h"
#include "sim/trajectories.h"

namespace npdr::sim {

struct SimulatorConfig;

/// A parameter of a policy.
struct PolicyParameter {
  std::string name;
  std::string unit;        ///< SI; "1" when dimensionless
  double initial = 0.0;    ///< value that a search begins with
  bool log_scale = false;  ///< positive, and searched by its logarithm
  std::string description;
};

/// Description of a closed-loop task.
struct PolicyTaskInfo {
  std::string policy;   ///< what it is
  std::string success;  ///< when a rollout is one
  std::vector<PolicyParameter> parameters;
  double dt = 0.0;      ///< [s]
  Index num_steps = 0;  ///< T, also the largest possible return
};

/// Settings of a closed-loop task.
struct PolicyTaskConfig {
  /// Domain parameters that the policy's own model of the system has in place of the simulator's
  /// nominal ones. They never follow the theta that is simulated.
  std::map<std::string, double> model = {};
  Index num_steps = 0;  ///< T; 0: the simulator's own
};

/// Outcomes of n rollouts.
struct PolicyRollouts {
  Vector returns;  ///< (n); NaN where the status isn't ok
  std::vector<Index>
      num_steps;  ///< (n) steps that were rewarded; T: limits were kept up to the last one
  std::vector<std::uint8_t> success;  ///< (n) 1 or 0
  /// (n) ok, or out_of_limits: domain parameters that are physically impossible. A state that
  /// leaves the task's limits, or diverges, is no such failure.
  std::vector<RolloutStatus> status;

  void resize(Index rows);
  Index num_rows() const { return returns.size(); }
};

/// Policy rollouts with their states and actions; a rollout that ends early has fewer of them, and
/// its last state is the one that ended it. Its actions are the a_t.
struct RecordedPolicyRollouts {
  PolicyRollouts outcomes;
  std::vector<Rollout> rollouts;  ///< (n)
};

/// Const calls are thread-safe.
class PolicyTask {
 public:
  virtual ~PolicyTask() = default;

  virtual const PolicyTaskInfo& info() const = 0;

  /// One rollout for each row of theta (n, P), initial_states (n, S) and policies (n, Q), on
  /// num_threads() threads. Row i of the result depends on row i of the three alone, to the bit:
  /// not on n, the other rows, or the number of threads. Memory is O(n) beside a block per thread.
  /// Throws ShapeError for other widths or row counts.
  virtual PolicyRollouts run(const RowMatrix& theta, const RowMatrix& initial_states,
                             const RowMatrix& policies) const = 0;

  /// Runs as run() does, and keeps all states and actions.
  virtual RecordedPolicyRollouts record(const RowMatrix& theta, const RowMatrix& initial_states,
                                        const RowMatrix& policies) const = 0;

  /// Rows of theta (n, P) that are physically possible, so that run() has returns for them.
  virtual std::vector<Index> possible_rows(const RowMatrix& theta) const = 0;

  /// n initial states (n, S) of the task's distribution; row i depends on `id` and i alone, which
  /// takes the place of id.row.
  virtual RowMatrix initial_states(Index n, const StreamId& id) const = 0;
};

/// The policy that a search begins with, (Q).
Vector initial_policy(const PolicyTaskInfo& info);

/// Policies (n, Q) as the search sees them, and back. Throws ShapeError for another width, and
/// InputError for a parameter on a log scale that isn't positive.
RowMatrix to_search_space(const PolicyTaskInfo& info, const RowMatrix& policies);
RowMatrix from_search_space(const PolicyTaskInfo& info, const RowMatrix& points);

/// The closed-loop task of a simulator. Throws InputError when it has none (and names those that
/// have one), and for a config that is unknown or out of range.
std::unique_ptr<PolicyTask> make_policy_task(const SimulatorConfig& simulator,
                                             const PolicyTaskConfig& config = {});

/// Names of the simulators that have a closed-loop task.
std::vector<std::string> simulators_with_policy_task();

}  // namespace npdr::sim
