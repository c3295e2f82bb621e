/// The embedding of BayesSim (Ramos et al. 2019, "BayesSim: adaptive domain randomization via
/// probabilistic inference for robotics simulators", eq. 22).
#pragma once

#include "inference/embeddings/embedding.h"

namespace npdr::inference {

/// Sums over each rollout, with ds_k = s_{k+1} - s_k and a_k the mean action applied between the
/// two states:
///   ( sum_k a_k ds_k^T  (A C values),  mean_k ds_k  (C),  variance_k ds_k  (C) ).
/// H (A C + 2 C) features; without down-sampling a_k is the action itself.
class BayesSim : public Embedding {
 public:
  /// Takes the actions of `target`; `steps_per_state` time steps lie between two kept states.
  BayesSim(SeriesSelection selection, const Target& target, Index steps_per_state);
  Index num_features() const override;
  void embed(std::span<const float> picked, std::span<float> x) const override;

 private:
  std::vector<RowMatrix> actions_;  ///< H x (K - 1, A)
};

}  // namespace npdr::inference
