/// One way to simulate rows of theta, whatever the study's simulator is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/random.h"
#include "core/target.h"
#include "core/types.h"
#include "sim/segments.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// The stream that names the random numbers of a simulation's rows.
inline constexpr const char* kSimulationStream = "external_simulation";
/// The same of a simulated target domain.
inline constexpr const char* kTruthStream = "external_truth";

/// The number of no row: for simulations beside a study's own, whose rows count on from there.
inline constexpr std::uint64_t kNoRow = std::uint64_t{1} << 62;

class RowSimulator {
 public:
  virtual ~RowSimulator() = default;

  /// Rows of all parameters (n, P) as rollouts (n, H, T, C), or features (n, 1, 1, F). `first`
  /// names the random numbers of row 0, and with its row counted on those of the others. Throws
  /// InputError for a damaged dataset, and what ExternalSimulator::simulate() throws.
  virtual sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) = 0;

  /// Rows that are worth simulating at once, of a shard of `num_rows`.
  virtual Index block_size(Index num_rows) const = 0;

  /// Calls of programs that share out rows among them and work at the same time.
  virtual Index num_calls() const { return 1; }

  /// Completes the log, and begins another; empty: none. For programs, whose output is kept.
  virtual void log_to(const std::filesystem::path& /*log*/) {}

  /// Why rows were lost, for people: the problem of a call, or else a number; where none was, that
  /// of a call which went well when it was repeated; "": there was none, or it can't say.
  virtual std::string last_failure() const { return ""; }

  /// What is probably wrong with rows that it gave last, as far as it can say.
  virtual Findings last_warnings() const { return {}; }
};

/// Features of a simulator that gives these, as (n, F).
inline Eigen::Map<const RowMatrixF> features_of(const sim::Trajectories& x) {
  return {x.values.data(), x.num_rows, x.row_size()};
}

/// Features as the states of a rollout of one step.
sim::Segments feature_segments(Index num_features);

/// The first number of a row that isn't finite, or isn't one that a float holds: "nan in 'omega',
/// step 17 of rollout 2". `row`: (N, C), N steps of all rollouts; without the step where
/// `num_steps`, those of one rollout, is 1, as of features. "": there is none.
std::string find_lost_number(std::span<const double> row, const std::vector<Channel>& channels,
                             Index num_steps);

/// The seed of row `i` after the row that `first` names: one that fits into a signed 32-bit
/// integer, as many programs want it.
std::uint32_t row_seed(StreamId first, Index i);

/// The log of the programs that make an artefact: it lies beside it.
std::filesystem::path log_of(const std::filesystem::path& artefact);

}  // namespace npdr::pipeline
