/// Evaluation artefacts: posterior samples, their densities and how well they predict.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "analysis/quantiles.h"
#include "inference/posterior.h"
#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// Levels of the bands whose coverage is kept, (L).
inline const std::vector<double> kBandLevels = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95};

/// How well posterior samples predict rollouts (analysis/predictive_scores.h), by channel; with
/// observation noise, where the study has any.
struct PredictionScores {
  Vector crps;               ///< (C)
  RowMatrix coverage;        ///< (L, C)
  Vector noisy_crps;         ///< (C); empty: there is no noise
  RowMatrix noisy_coverage;  ///< (L, C)
  Vector log_score;          ///< (C) [nats]; empty: a channel has no noise
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
  std::optional<RowMatrixF> x;                      ///< (n, F), of a simulator that gives features
  std::optional<analysis::Bands> bands;             ///< of one that gives rollouts
  std::optional<PredictionScores> scores;           ///< of rollouts
  std::optional<PredictionScores> held_out_scores;  ///< of those that were held out
};

/// Throws Error.
void write_evaluation(h5::File& file, const Study& study, Evaluation evaluation);
/// Throws InputError.
Evaluation read_evaluation(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
