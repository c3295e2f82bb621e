/// Evaluation artefacts: posterior samples, their densities and how well they predict.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "analysis/quantiles.h"
#include "inference/posterior.h"
#include "pipeline/artefacts/prediction_scores.h"
#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"

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
  std::optional<InferredNoise> noise;  ///< where any of its parameters is inferred
};

/// Throws Error.
void write_evaluation(h5::File& file, const Study& study, Evaluation evaluation);
/// Throws InputError.
Evaluation read_evaluation(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
