/// Maximum likelihood of a conditional density network, with or without weights:
///   loss = -(1 / n) sum_i w_i log q(v_i | c_i).
///  - of u given z (NPE): v = u, c = z(x);
///  - of z given u (NLE; Papamakarios, Sterratt and Murray 2019): v = z(x), c = u.
/// NPE-B (SNPE-B; Lueckmann et al. 2017, eq. 5) weights simulations that don't come from the prior
/// by w = p(u) / p~(u), with p~ what they were drawn from, and so does "npe_nle" those of several
/// rounds, within a region of the prior (round_task.h); NPE-A takes only those of the last round.
#pragma once

#include <vector>

#include "inference/algorithms/training_data.h"
#include "inference/estimators/embedded_estimator.h"
#include "inference/feature_transform.h"
#include "inference/training/trainer.h"

namespace npdr::inference {

class LikelihoodObjective : public Objective {
 public:
  enum class Of { u_given_z, z_given_u };

  /// `rows` of the data are used; `weights` (N), or empty: all 1. Keeps references to its arguments
  /// but for the last two.
  LikelihoodObjective(Of of, const EmbeddedEstimator<float>& network,
                      const FeatureTransform& transform, const TrainingData& data,
                      std::vector<std::uint32_t> rows, VectorF weights);

  Index num_rows() const override { return static_cast<Index>(rows_.size()); }
  double loss(const Parameters<float>& parameters, const Batch& batch,
              Parameters<float>* gradient) override;

 private:
  Of of_;
  const EmbeddedEstimator<float>& network_;
  const FeatureTransform& transform_;
  const TrainingData& data_;
  std::vector<std::uint32_t> rows_;
  VectorF weights_;
  EmbeddedEstimator<float>::Scratch scratch_;
  std::vector<std::uint32_t> batch_rows_;  ///< of the data
  RowMatrixF raw_x_, z_, u_;               ///< (n, F), (n, F or k), (n, D)
  VectorF log_prob_, d_log_prob_;          ///< (n)
};

}  // namespace npdr::inference
