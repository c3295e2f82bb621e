/// Evaluation artefacts: posterior samples, their densities and how well they predict; and baseline
/// artefacts: what single parameter vectors, and the prior, reach, to compare posteriors with.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/misfit.h"
#include "analysis/quantiles.h"
#include "inference/posterior.h"
#include "inference/prior.h"
#include "pipeline/artefacts/schemas.h"

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
  /// Share of num_compared samples that would be within bands of kJudgedBand as seldom as what was
  /// recorded (analysis::compare_coverage); 0: predictions are too narrow.
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

/// Parameters of the noise that a posterior's predictions are given (sim/noise_model.h), of each
/// sample and channel; NaN of samples that failed.
struct InferredNoise {
  RowMatrix scale;               ///< (n, C)
  RowMatrix correlation;         ///< (n, C); empty: of white noise
  RowMatrix degrees_of_freedom;  ///< (n, C); empty: of Gaussian noise
};

struct Evaluation {
  RowMatrix theta;                        ///< (n, D)
  Vector log_prob;                        ///< (n)
  std::map<std::string, Vector> metrics;  ///< (n) each
  Vector map_theta;                       ///< (D)
  double map_log_prob = 0.0;
  std::map<std::string, double> map_metrics;
  std::optional<double> nominal_log_prob;  ///< none: the simulator has no nominal parameters
  std::optional<double> truth_log_prob;
  std::map<std::string, double> reference_log_prob;
  std::optional<inference::SamplerReport> sampler;
  std::optional<RowMatrixF> x;                    ///< (n, F), of a simulator that gives features
  std::optional<analysis::Bands> bands;           ///< of one that gives rollouts
  std::optional<analysis::Bands> held_out_bands;  ///< of those that were held out
  RolloutScores scores;
  std::optional<InferredNoise> noise;                ///< where any of its parameters is inferred
  std::vector<inference::Marginal> parameters = {};  ///< of theta's columns; not read
  std::vector<Channel> features = {};                ///< of x's columns; not read
};
void describe(Layout f, Evaluation& evaluation);

struct BaselinePoint {
  std::string name;
  Vector theta;                           ///< (D)
  std::map<std::string, double> metrics;  ///< NaN when the rollout failed
  RolloutScores scores = {};              ///< of its rollouts alone
};

/// Predictions by draws of the prior.
struct PriorPredictions {
  std::map<std::string, Vector> metrics;  ///< (n) each; NaN where the rollouts failed
  RolloutScores scores = {};
};

/// What a fit from the floor leaves of a recording.
struct RecordingMisfit : analysis::Misfit {
  bool noise_is_given = false;  ///< else it is what neighboring samples scatter by
  double limit = 0.0;           ///< of `times`, above which the simulator lacks something
  double expected = 1.0;        ///< `times` of a right one, whose fit takes some noise away
  std::string cause = {};       ///< the fault of the recording that explains it best; "": none
  std::string change = {};      ///< that would mend it
  double times_of_cause = 0.0;  ///< `times` with that change

  bool is_beyond() const { return times > limit; }
};

struct Baseline {
  std::vector<BaselinePoint> points;
  std::optional<PriorPredictions> prior;             ///< none of a dataset
  std::optional<RecordingMisfit> misfit = {};        ///< where there is a floor, and a fit
  std::vector<inference::Marginal> parameters = {};  ///< of theta's columns; not read
};
void describe(Layout f, Baseline& baseline);

}  // namespace npdr::pipeline
