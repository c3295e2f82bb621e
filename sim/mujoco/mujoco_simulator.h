/// The simulator that a model of MuJoCo is: its parameters, its channels, its replay.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/library/npdr_simulator.h"
#include "sim/mujoco/model.h"
#include "sim/mujoco/parameters.h"

namespace npdr::mujoco {

/// A state channel: the position or velocity of a hinge or slide, or a sensor.
struct StateChannel {
  enum class Source { position, velocity, sensor };
  std::string label;
  std::string unit = {};
  Source source = Source::position;
  int address = 0;  ///< in qpos, qvel or sensordata
  /// Where a segment's first state is written to: qpos, qvel, or nowhere (sensor).
  Source first = Source::sensor;
  int first_address = 0;
};

/// Not thread-safe: it has a model and its data, which a replay changes.
class MujocoSimulator {
 public:
  /// `settings`: JSON with `model`, a file, and lists of names, `parameters` (parameters.h; null:
  /// those that are usually unknown), `states` (those of all hinges and slides, NAME and NAME_dot,
  /// where it is empty) and `actions` (all actuators). A state is the name of a joint, with _dot
  /// its velocity, or that of a sensor with one number; names may be followed by a unit: "pole
  /// [rad]". Throws std::runtime_error.
  explicit MujocoSimulator(const std::string& settings);

  npdr_description description() const;

  /// Does what replay() of npdr_simulator.h promises. Every segment begins with positions and
  /// velocities of its first state, those of other joints as in the model, and with the model's
  /// actuators and solver as they are after a reset. Throws std::runtime_error.
  void replay(const npdr_batch& batch, double* states, std::uint8_t* status);

 private:
  struct Run;

  void find_states(const std::vector<std::string>& names);
  void describe_unrecorded();
  void find_actions(const std::vector<std::string>& names);
  bool apply(const double* theta);
  bool run(const npdr_batch& batch, double* states);
  void run_segment(const npdr_batch& batch, std::int64_t segment, std::int64_t begin,
                   double* states);
  void set_controls(const npdr_batch& batch, std::int64_t step, std::int64_t past, int substep,
                    int num_substeps);
  void read_state(double* state) const;

  Spec spec_;
  Model nominal_;
  Model model_;  // of a row: every parameter is written anew
  Data data_;
  std::vector<MujocoParameter> parameters_;
  std::vector<double> delays_;  // (nu) of a row [steps]
  std::vector<StateChannel> states_;
  std::vector<int> actuators_;  // of each action
  bool reads_sensors_ = false;
  std::string fingerprint_, text_;
  std::vector<std::string> action_labels_, action_units_;
  std::vector<npdr_parameter> described_parameters_;
  std::vector<npdr_channel> described_states_, described_actions_;
};

}  // namespace npdr::mujoco
