/// Baseline artefacts: what single parameter vectors, and the prior, reach, to compare posteriors
/// with.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "inference/prior.h"
#include "pipeline/artefacts/prediction_scores.h"
#include "pipeline/artefacts/schemas.h"

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
  std::optional<PriorPredictions> prior;             ///< none of a dataset
  std::vector<inference::Marginal> parameters = {};  ///< of theta's columns; not read
};
void describe(Layout f, Baseline& baseline);

}  // namespace npdr::pipeline
