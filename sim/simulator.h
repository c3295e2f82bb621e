/// The interface of every simulator: theta -> trajectories.
///
/// A simulator replays what the target domain did. Every rollout of the target is simulated from
/// its recorded initial state with its recorded actions (zero-order hold over a step). With
/// segment_length = L > 0 the simulation restarts from the recorded state every L steps, so that a
/// simulated rollout is the concatenation of its segments. State t of the result (t = 1, ..., T) is
/// the state after action t; the recorded state at a restart is never part of it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/outline.h"
#include "core/target.h"
#include "core/types.h"
#include "sim/integrator.h"
#include "sim/minigolf/minigolf_config.h"
#include "sim/parameter.h"
#include "sim/policy_task.h"
#include "sim/regression_form.h"
#include "sim/trajectories.h"

namespace npdr::sim {

/// Settings of a simulator, as a study gives them.
struct SimulatorConfig {
  std::string name = {};                          ///< a name of simulator_names()
  std::map<std::string, double> parameters = {};  ///< values that replace the nominal ones
  Index segment_length = 0;                       ///< [steps]; 0: one segment, the whole rollout
  Integrator integrator = Integrator::erk4;
  Index substeps = 1;            ///< integrator steps per time step of the target
  Index store_every = 1;         ///< keep every k-th state
  MinigolfConfig minigolf = {};  ///< of the simulator "minigolf"
};

/// Description of a simulator. `dt` and `num_steps` are those of its own behavior policy.
struct SimulatorInfo {
  std::string name;
  std::string description;
  std::vector<Parameter> parameters;
  std::vector<Channel> state_channels;
  std::vector<Channel> action_channels;
  double dt = 0.0;      ///< [s]
  Index num_steps = 0;  ///< per rollout
  std::optional<Goal> goal = {};
};

/// A simulator with its settings. Const calls are thread-safe.
class Simulator {
 public:
  virtual ~Simulator() = default;

  virtual const SimulatorInfo& info() const = 0;

  /// Simulates each row of `theta` (n, P), all P = info().parameters.size() parameters in that
  /// order, against every rollout of `target`. Row i of the result depends on theta.row(i) and the
  /// target alone, to the bit: not on n, the other rows, or the number of threads. A rollout that
  /// fails, or a parameter outside of what is physically possible, sets the row's status and NaN;
  /// nothing is thrown for it.
  /// Throws ShapeError for a theta of other width, InputError for a target with other channels.
  virtual Trajectories replay(const Target& target, const RowMatrix& theta) const = 0;

  /// Rollouts of a simulated target domain at the truth `theta` (P), under the simulator's own
  /// behavior policy and initial states; `seed` picks them where they are random.
  virtual Target behave(const Vector& theta, Index num_rollouts, std::uint64_t seed) const = 0;

  /// Shapes in the plane of the first two state channels, at all P parameters `theta`, for figures
  /// from above. None: the system doesn't move on a plane.
  virtual std::vector<Outline> outlines(const Vector& theta) const;

  /// The equations of motion as a linear regression; nullptr: they aren't one.
  virtual std::unique_ptr<RegressionForm> regression_form() const;

  /// The closed-loop task, with this simulator's nominal parameters, integrator and substeps;
  /// nullptr: it has none. Outlives the simulator. Throws InputError for a config that is unknown
  /// or out of range. make_policy_task() of sim/policy_task.h is for those who need one.
  virtual std::unique_ptr<PolicyTask> policy_task(const PolicyTaskConfig& config) const;
};

/// Names that make_simulator() knows.
std::vector<std::string> simulator_names();
/// Fields of SimulatorConfig that mean nothing to the simulator `name`, one of simulator_names().
std::vector<std::string> unused_settings(const std::string& name);
/// A number that is raised when the simulator's rollouts change their bits: part of their keys
/// from 2 on.
int rollout_version(const std::string& name);
/// Names of the simulators that have a regression_form().
std::vector<std::string> simulators_with_regression();

/// Throws InputError for a config that is unknown or out of range: names the field, the value and
/// what is allowed.
std::unique_ptr<Simulator> make_simulator(const SimulatorConfig& config);

/// The position in theta of the parameter `name`. Throws InputError for an unknown name (with the
/// nearest known one).
Index parameter_index(const SimulatorInfo& info, const std::string& name);

/// All P parameters: `values` where named there, the simulator's nominal ones elsewhere.
/// Throws InputError for an unknown name.
Vector complete_theta(const Simulator& simulator, const std::map<std::string, double>& values);
Vector complete_theta(const SimulatorInfo& info, const std::map<std::string, double>& values);

}  // namespace npdr::sim
