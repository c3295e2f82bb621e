/// The gradient of a whole objective, from the features of a batch to its loss.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "inference/algorithms/training_data.h"
#include "inference/direct_posterior.h"
#include "inference/matrix_features.h"
#include "inference/training/trainer.h"
#include "tests/inference/tasks.h"

namespace npdr::inference {

/// 60 simulations of two rounds in two dimensions, and a batch of 20 of them.
struct SmallBatch {
  SmallBatch() {
    data.u = prior.to_normal(theta).cast<float>();
    std::fill_n(data.round.begin(), 30, 1u);
    data.proposals = {
        {Vector::Zero(1), {Vector::Constant(2, 0.3)}, {Eigen::MatrixXd::Identity(2, 2) * 1.5}}};
    for (std::uint32_t i = 0; i < 20; ++i) rows.push_back(3 * i);
  }
  SmallBatch(const SmallBatch&) = delete;
  Batch batch() const { return {rows, 1, 0}; }

  LinearGaussian task{2};
  Prior prior = task.prior();
  RowMatrix theta = sample_prior(prior, 60, 1);
  RowMatrixF values = simulate(task.simulator(), theta, 1, 1);
  MatrixFeatures x{values};
  FeatureTransform transform{VectorF::Zero(2), VectorF::Ones(2), {}};
  TrainingData data{&x, {}, std::vector<std::uint32_t>(60, 2), {}};
  std::vector<std::uint32_t> rows;
};

/// Single precision throughout: differences of the loss are good to about 1e-3.
inline void expect_slope_is_gradient(Objective& objective, const Parameters<float>& p,
                                     const Batch& batch, const std::string& what) {
  Parameters<float> gradient = Parameters<float>::Zero(p.size());
  objective.loss(p, batch, &gradient);
  const float norm = gradient.norm();  // the slope along the gradient
  const Parameters<float> direction = gradient / norm;
  constexpr float step = 1e-2f;
  const double slope = (objective.loss(p + step * direction, batch, nullptr) -
                        objective.loss(p - step * direction, batch, nullptr)) /
                       (2.0 * static_cast<double>(step));
  EXPECT_NEAR(slope / static_cast<double>(norm), 1.0, 0.01) << what;
}

}  // namespace npdr::inference
