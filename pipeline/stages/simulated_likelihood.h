/// The likelihood of a recording, by simulation. Private to pipeline/stages.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/features/observation.h"
#include "pipeline/predictions/left_out.h"
#include "sim/noise_likelihood.h"

namespace npdr::pipeline {

/// What first order says of first states against what is simulated from them.
struct LikeliestFirstStates {
  double off = 0.0;       ///< distance() of both; infinite where that can't be simulated
  RowMatrix errors = {};  ///< (S, C) over a; empty where first order does, or none that fit better
  bool is_coarse() const { return !(off <= 0.25); }  ///< by more than a quarter of a deviation
};

/// log p(recording | theta) of rows of theta, under the observation noise. A row's value is a
/// function of theta, its number and the first states that simulations begin in: it has the same
/// bits whoever simulates it, and with which others.
class SimulatedLikelihood {
 public:
  /// Of the refinement `node`. `log`: of what programs print. Throws InputError for noise without a
  /// density, and what opening the study's source throws.
  SimulatedLikelihood(const Plan& plan, const Node& node, const std::filesystem::path& log);

  Index num_rollouts() const { return observation_.target().num_rollouts(); }
  /// Numbers of a row's rollouts, H K C, or H (1 + C) K C where first states are inferred.
  Index num_values() const;
  /// Rows that are worth simulating at once, of `num_rows`.
  Index block_size(Index num_rows) const { return simulator_->block_size(num_rows); }

  /// The words of a call of a program that failed; "": none has.
  std::string last_failure() const { return simulator_->last_failure(); }

  bool infers_first_states() const { return noise_.infers_first_states(); }
  /// Errors (S, C), over a, of recorded first states that simulations begin without, where they are
  /// inferred; else empty.
  RowMatrix first_errors() const;
  /// Makes them others. Throws ShapeError for those of another number of segments, and what opening
  /// the study's source throws.
  void begin_without(const RowMatrix& first_errors);
  /// The likeliest ones of theta (D), where first order is too coarse around those that simulations
  /// begin in. Throws what opening the study's source throws.
  LikeliestFirstStates likeliest_first_states(const Vector& theta) const;

  /// Throws InputError when rollouts of a simulator of the user's don't follow from theta: those of
  /// a few draws of the prior that don't fail, each simulated twice with other seeds, differ by
  /// more than 0.1 % of a channel's deviation.
  void require_deterministic() const;

  /// Rollouts of rows of theta (n, D), number `first` and those after it. Throws as
  /// RowSimulator::simulate().
  sim::Trajectories simulate(const RowMatrix& theta, Index first) const;
  /// log p of each row (n) [nats]. Adds to `failed` how many couldn't be simulated.
  Vector of(const sim::Trajectories& rows, Index& failed) const;

  /// What is left of the recording by theta (D); none where it can't be simulated.
  std::optional<sim::ErrorMemory> residuals(const Vector& theta) const;

  /// Score of the posterior at that power, by rollouts of its weighted draws; with the same random
  /// numbers for each power.
  LeftOutScore left_out(const sim::Trajectories& rows, const Vector& weights, double power) const;

 private:
  // Of simulations from the first states of a likelihood, up to so many rows at once.
  std::unique_ptr<RowSimulator> open(const sim::NoiseLikelihood& noise, Index num_rows,
                                     const std::filesystem::path& log) const;
  Index num_equal_pairs(const sim::Trajectories& twice) const;
  // None: it fails.
  std::optional<sim::Trajectories> simulate_one(RowSimulator& simulator, const Vector& theta) const;

  const Plan& plan_;
  std::filesystem::path log_;
  const RefineConfig& config_;
  Observation observation_;
  sim::NoiseLikelihood noise_;
  std::unique_ptr<RowSimulator> simulator_;
  StreamId id_;
};

}  // namespace npdr::pipeline
