/// The objective of NRE-A and NRE-B (ratio_loss.h): the other values of u for an x are taken from
/// other simulations of the batch.
#pragma once

#include "inference/algorithms/algorithm_config.h"
#include "inference/algorithms/training_data.h"
#include "inference/estimators/ratio_estimator.h"
#include "inference/feature_transform.h"
#include "inference/training/trainer.h"

namespace npdr::inference {

class RatioObjective : public Objective {
 public:
  /// num_atoms values of u for each x with the categorical loss ("nre_b"), 2 with the binary one
  /// ("nre_a"). Keeps references to its arguments but the first.
  RatioObjective(const AlgorithmConfig& algorithm, const RatioEstimator<float>& network,
                 const FeatureTransform& transform, const TrainingData& data, const StreamId& id);

  Index num_rows() const override { return data_.u.rows(); }
  double loss(const Parameters<float>& parameters, const Batch& batch,
              Parameters<float>* gradient) override;

 private:
  bool is_binary_;
  Index num_atoms_;
  const RatioEstimator<float>& network_;
  const FeatureTransform& transform_;
  const TrainingData& data_;
  StreamId id_;
  RatioScratch<float> scratch_;
  RowMatrixF raw_x_, z_, atoms_;  ///< (n, F), (n, F or k), (n k, D)
  VectorF logits_, d_logits_;     ///< (n k)
};

}  // namespace npdr::inference
