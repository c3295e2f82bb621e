/// The posterior of a linear-Gaussian task in three dimensions, which is known, against an
/// estimate.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/inference/tasks.h"

namespace npdr::inference {

// Networks that are small, but large enough for this task.
inline PosteriorEstimationConfig small_config(Algorithm algorithm, EstimatorKind estimator,
                                              Index rounds, Index simulations) {
  PosteriorEstimationConfig c;
  c.algorithm.kind = algorithm;
  c.algorithm.num_rounds = rounds;
  c.algorithm.num_simulations = simulations;
  c.estimator.kind = estimator;
  c.estimator.num_transforms = 3;
  c.estimator.num_components = 4;
  c.estimator.hidden_features = 30;
  c.training.learning_rate = 1e-3;
  return c;
}

// The estimate is a network trained on few simulations: its own error dominates the Monte Carlo
// error of 10,000 samples (1 % of a deviation). Deviations have to be right to 15 %: a posterior
// that isn't corrected for its proposal has about twice the precision, 0.71 of the deviation. Means
// and correlations, which that doesn't change, have bounds that estimates of this size keep with
// some room; `slack` widens them for algorithms whose estimates are cruder.
inline void expect_linear_gaussian(const PosteriorEstimationConfig& c, double slack = 1.0) {
  const LinearGaussian task(3);
  const Prior prior = task.prior();
  VectorF x_o(3);
  x_o << 0.8f, -0.5f, 1.0f;
  const auto posterior = infer(c, prior, task.simulator(), x_o, 1);
  constexpr Index n = 10'000;
  const RowMatrix samples = posterior->sample(n, {1, "posterior", 0, 0, 0});
  const Vector mean = samples.colwise().mean().transpose();
  const RowMatrix centered = samples.rowwise() - mean.transpose();
  const Eigen::MatrixXd covariance = centered.transpose() * centered / static_cast<double>(n);
  const Vector deviation = task.covariance().diagonal().cwiseSqrt();
  std::cout << "means off by " << ((mean - task.mean(x_o)).array() / deviation.array()).transpose()
            << " deviations; deviations over the exact ones "
            << (covariance.diagonal().array().sqrt() / deviation.array()).transpose() << '\n';
  for (Index d = 0; d < 3; ++d) {
    EXPECT_NEAR(mean(d), task.mean(x_o)(d), slack * 0.25 * deviation(d)) << "mean " << d;
    EXPECT_NEAR(std::sqrt(covariance(d, d)) / deviation(d), 1.0, 0.15) << "deviation " << d;
    for (Index e = 0; e < d; ++e) {
      EXPECT_NEAR(covariance(d, e) / (deviation(d) * deviation(e)),
                  task.covariance()(d, e) / (deviation(d) * deviation(e)), slack * 0.15);
    }
  }
}

}  // namespace npdr::inference
