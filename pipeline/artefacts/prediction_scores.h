/// Scores of predicted rollouts, as artefacts keep them.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/artefacts/layout.h"

namespace npdr::pipeline {

/// Levels of the bands whose coverage is kept, (L).
inline const std::vector<double> kBandLevels = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95};

/// Of those, the one by which an observation is compared with the samples' own.
inline constexpr double kJudgedBand = 0.9;

/// How well posterior samples predict rollouts (analysis/predictive_scores.h), by channel; with
/// observation noise, where the study has any.
struct PredictionScores {
  Vector crps;               ///< (C)
  RowMatrix coverage;        ///< (L, C)
  Vector noisy_crps;         ///< (C); empty: there is no noise
  RowMatrix noisy_coverage;  ///< (L, C)
  Vector log_score;          ///< (C) [nats]; empty: a channel has no noise
  /// Share of num_compared samples that would, with noise where there is any, be within bands of
  /// kJudgedBand as seldom as what was recorded (analysis::compare_coverage): 0 says that
  /// predictions are too narrow.
  double share_as_seldom_within = 1.0;
  Index num_compared = 0;
};

/// Of the rollouts that inference saw and, where there are any, of those that were held out; empty
/// for features.
struct RolloutScores {
  std::optional<PredictionScores> seen;
  std::optional<PredictionScores> held_out;
};

/// The groups `scores` and `held_out_scores`.
void describe(Layout f, RolloutScores& scores);

}  // namespace npdr::pipeline
