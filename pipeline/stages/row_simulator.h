/// One way to simulate rows of theta, whatever the study's simulator is.
#pragma once

#include <memory>

#include "core/random.h"
#include "pipeline/plan/plan.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

class RowSimulator {
 public:
  virtual ~RowSimulator() = default;

  /// Simulates rows of all parameters (n, P). `first` names the random numbers of row 0, and with
  /// its row counted on those of the others, for a simulator that draws some.
  virtual sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) const = 0;

  /// What the simulator said when it failed last; "": nothing, or it can't say.
  virtual std::string last_failure() const { return ""; }
};

/// A built-in simulator that replays `target`, with the settings `config`; or the study's command,
/// in calls of at most simulate.shard_size rows, whose output goes to `log`. Not for a dataset.
std::unique_ptr<RowSimulator> make_row_simulator(const Plan& plan,
                                                 const sim::SimulatorConfig& config,
                                                 const Target& target,
                                                 const std::filesystem::path& log);

/// The stream that names the random numbers of a simulation's rows; see RowSimulator::simulate().
inline constexpr const char* kSimulationStream = "external_simulation";

/// Where the command's output goes that belongs to an artefact.
std::filesystem::path log_of(const std::filesystem::path& artefact);

}  // namespace npdr::pipeline
