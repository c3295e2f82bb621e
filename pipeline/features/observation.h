/// The target domain as a study observes it.
#pragma once

#include <vector>

#include "core/target.h"
#include "inference/embeddings/embedding.h"
#include "pipeline/config/study.h"
#include "sim/noise_model.h"

namespace npdr::pipeline {

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

}  // namespace npdr::pipeline
