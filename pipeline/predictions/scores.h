/// Scores of posterior predictions (analysis/predictive_scores.h), of the stored states.
#pragma once

#include <vector>

#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/plan/plan.h"
#include "sim/noise_model.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Values of the noise's parameters of each channel (C), for each sample (n): those that aren't
/// known are drawn from what the recording says of them, given the sample's rollouts.
using NoiseOfSamples = std::vector<std::vector<sim::NoiseValues>>;

/// `all_states`: the samples' rollouts against `target`, every state. Empty without noise.
NoiseOfSamples draw_noise(const Plan& plan, const Target& target,
                          const sim::Trajectories& all_states, const StreamId& id);

/// Scores of the samples' rollouts as predictions of `target`, with and without noise.
PredictionScores score(const Plan& plan, const Target& target, const sim::Trajectories& all_states,
                       const NoiseOfSamples& noise, const StreamId& id);

}  // namespace npdr::pipeline
