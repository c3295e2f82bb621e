/// Scores of posterior predictions (analysis/predictive_scores.h), of the stored states.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/plan/plan.h"
#include "pipeline/predictions/prediction.h"
#include "sim/noise_model.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Values of the noise's parameters of each channel (C), for each sample (n): those that aren't
/// known are drawn from what the recording says of them, given the sample's rollouts.
using NoiseOfSamples = std::vector<std::vector<sim::NoiseValues>>;

/// What is known of a posterior's samples when their noise is drawn.
struct NoiseSource {
  double power = 1.0;   ///< of the likelihood in the posterior
  double factor = 1.0;  ///< of the noise's unknown scales: PowerScores::noise_factor
  /// Predictions begin in recorded first states, which aren't exact: what that does to them counts
  /// as noise, whose scale so isn't known even where it is given.
  bool infers_first_states = false;
};

/// Of the posterior of a node. Throws InputError.
NoiseSource noise_source(const Plan& plan, const Node& posterior);

/// `observation`: the rollouts that the posterior has seen; `simulated`: the samples' rollouts,
/// which begin with those, every state of them or the stored ones. At a power below 1 a value is
/// drawn given the rollouts of another sample, in proportion to the rest of the likelihood: how far
/// off samples are because they are many isn't noise. Empty without noise.
NoiseOfSamples draw_noise(const Observation& observation, const sim::Trajectories& simulated,
                          const NoiseSource& source, const StreamId& id);

/// The same of `num_samples` draws of the noise's own prior, which no recording informs.
NoiseOfSamples draw_prior_noise(const Observation& observation, Index num_samples,
                                const StreamId& id);

/// What the recording says of the noise, as evaluations keep it. `noise`: that of the samples'
/// predictions, `seen`: their rollouts. NaN of samples that failed, whose values are the prior's.
/// None where all parameters of the noise are given.
std::optional<InferredNoise> inferred_noise(const sim::NoiseModel& model,
                                            const NoiseOfSamples& noise,
                                            const sim::Trajectories& seen);

/// Scores of the samples' rollouts, every state, as predictions of those that `judge` knows: with
/// noise, of which there may be none, and without. Not for features.
RolloutScores score(const Judge& judge, const PredictedRollouts& predicted,
                    const NoiseOfSamples& noise, const StreamId& id);

}  // namespace npdr::pipeline
