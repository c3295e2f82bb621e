/// Data that the objectives of all algorithms train on.
#pragma once

#include <vector>

#include "inference/estimators/gaussian_mixture.h"
#include "inference/feature_source.h"

namespace npdr::inference {

/// The simulations of all rounds so far. Failed ones are left out before.
struct TrainingData {
  const FeatureSource* x = nullptr;        ///< (N, F)
  RowMatrixF u;                            ///< (N, D)
  std::vector<std::uint32_t> round;        ///< (N), counted from 1
  std::vector<GaussianMixture> proposals;  ///< of rounds 2, 3, ...; analytic loss only
};

}  // namespace npdr::inference
