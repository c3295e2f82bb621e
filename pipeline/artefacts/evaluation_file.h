/// Evaluation artefacts: posterior samples, their densities and how well they predict.
///
///   theta     (n, D) float64: posterior samples
///   log_prob  (n): their posterior density, nats
///   one dataset (n) per metric: "rmse", "dtw", ...; NaN where the rollouts failed; those of
///   held-out rollouts are "held_out_rmse", ...
///   map/theta (D), map/log_prob and one number per metric: the most likely parameters
///   nominal_log_prob for a built-in simulator, and truth_log_prob for a simulated target
///   reference/name (k) and reference/log_prob (k) of the study's references, where it has any
///   sampler/r_hat (D), sampler/ess (D, or 1 of importance weights), attribute num_evaluations:
///   of posteriors that have to be sampled
///   bands/lower, bands/median, bands/upper (H, T, C) float32: 5, 50, 95 % of the rollouts
///   x (n, F) float32: what a simulator that gives features predicts, in place of the bands
#pragma once

#include <map>
#include <optional>
#include <string>

#include "analysis/quantiles.h"
#include "inference/posterior.h"
#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

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
  std::optional<RowMatrixF> x;           ///< (n, F), of a simulator that gives features
  std::optional<analysis::Bands> bands;  ///< of one that gives rollouts
};

void write_evaluation(h5::File& file, const Study& study, const Evaluation& evaluation);
/// Throws InputError.
Evaluation read_evaluation(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
