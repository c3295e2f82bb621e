/// Evaluation artefacts: posterior samples, their densities and how well they predict.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "analysis/quantiles.h"
#include "inference/posterior.h"
#include "inference/prior.h"
#include "pipeline/artefacts/prediction_scores.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

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

}  // namespace npdr::pipeline
