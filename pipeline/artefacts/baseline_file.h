/// Baseline artefacts: what single parameter vectors, and the prior, reach, to compare posteriors
/// with.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "inference/prior.h"
#include "pipeline/artefacts/prediction_scores.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

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

struct Baseline {
  std::vector<BaselinePoint> points;
  std::optional<PriorPredictions> prior;  ///< none of a dataset
};

/// Throws Error.
void write_baseline(h5::File& file, const std::vector<inference::Marginal>& prior,
                    Baseline baseline);
/// Throws InputError.
Baseline read_baseline(const ArtefactFile& baseline);

}  // namespace npdr::pipeline
