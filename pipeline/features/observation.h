/// The target domain as a study observes it, and series of states in a few numbers.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/target.h"
#include "inference/embeddings/embedding.h"
#include "pipeline/plan/plan.h"
#include "sim/noise_model.h"

namespace npdr::pipeline {

/// The target domain that `node` needs; `num_rollouts` > 0: only the first ones. Throws InputError.
Target read_target(const Plan& plan, const Node& node, Index num_rollouts = 0);

/// The target rollouts that the method of `node` sees: its first ones of each iteration.
Target read_seen_target(const Plan& plan, const Node& node);

/// The rollouts that inference sees before anything is made: recorded ones, or those that the truth
/// is simulated for here. Throws what Source::behave() does.
Target make_seen_target(const Plan& plan);

/// The rollouts that inference doesn't see, where the study has any.
std::optional<Target> read_held_out(const Plan& plan, const Node& node);

/// Observation noise of the stored states of `target`, of all channels, or of `channels`.
sim::NoiseModel noise_model(const Study& study, const Target& target,
                            std::vector<Index> channels = {});

/// Rollouts of the target, or x_o, with the noise that they are observed with. A simulated truth is
/// observed once, with all that it does, under the same noise as the simulations (its own random
/// stream): a rollout has the same noise wherever it is looked at. A recording, or an x_o that was
/// measured, is as it is. Keeps a reference to `study`.
class Observation {
 public:
  Observation(const Study& study, Target target);

  const Study& study() const { return study_; }
  /// Without noise.
  const Target& target() const { return target_; }
  /// Noise of the stored states, of all channels.
  const sim::NoiseModel& noise() const { return noise_; }
  /// Noise of the channels that an embedding picks.
  sim::NoiseModel noise_of(const inference::SeriesSelection& selection) const;

  /// The stored states as they are observed, (H, K, C).
  const std::vector<float>& states() const { return states_; }
  /// Those that an embedding picks, (H, K, C').
  std::vector<float> picked(const inference::SeriesSelection& selection) const;
  /// Features of the observation, (F).
  VectorF x_o(const inference::Embedding& embedding) const;

 private:
  const Study& study_;
  Target target_;
  sim::NoiseModel noise_;
  std::vector<float> states_;
};

/// Summary of a picked series (H, K, C') for people to compare: mean, deviation, minimum, maximum
/// and last state of each channel of each rollout, 5 H C' values, rollout by rollout, channel by
/// channel. A single state, such as the features that a command gives, is its own summary: H C'
/// values.
Vector summarize(std::span<const float> picked, const inference::SeriesSelection& selection);

/// "rollout 1, theta: mean", ...: the names of those values.
std::vector<std::string> summary_names(const inference::SeriesSelection& selection,
                                       const std::vector<Channel>& channels);

}  // namespace npdr::pipeline
