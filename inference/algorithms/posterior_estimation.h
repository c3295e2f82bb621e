/// One round of neural posterior estimation: simulations of all rounds so far -> posterior.
#pragma once

#include <optional>
#include <vector>

#include "inference/algorithms/algorithm_config.h"
#include "inference/algorithms/npe_c.h"
#include "inference/posterior.h"
#include "inference/training/trainer.h"

namespace npdr::inference {

/// Settings of neural posterior estimation.
struct PosteriorEstimationConfig {
  AlgorithmConfig algorithm;
  EstimatorConfig estimator;
  TrainingConfig training;
  Index principal_components = 0;  ///< of x that the network sees; 0: x itself
  Index trained_features = 0;      ///< width of the linear layer; 0: none
};

/// The simulations of all rounds so far, the failed ones left out, and what was observed.
struct RoundData {
  const Prior* prior = nullptr;
  const FeatureSource* x = nullptr;        ///< (N, F)
  RowMatrix theta;                         ///< (N, D)
  std::vector<std::uint32_t> round;        ///< (N), counted from 1
  std::vector<GaussianMixture> proposals;  ///< of rounds 2, 3, ... when the loss is analytic
  VectorF x_o;                             ///< (F)
};

/// Trains on `data` from the weights and the feature transform of `previous` (the last round's
/// posterior) or from scratch in round 1. `id` names the seed and round. A `state` that a hook kept
/// goes on from there with the same bits; an empty one starts. Returns nothing when the hook
/// stopped training: `state` is the checkpoint. Throws ShapeError for the state of another network.
std::optional<DirectPosterior> estimate_posterior(const PosteriorEstimationConfig& config,
                                                  const RoundData& data,
                                                  const DirectPosterior* previous,
                                                  const StreamId& id, TrainingState& state,
                                                  const EpochHook& hook);

/// (n, D) proposals of theta for the next round, drawn from the posterior estimate; for the
/// analytic loss from proposal_mixture(), which that loss can correct for.
RowMatrix propose(const PosteriorEstimationConfig& config, const DirectPosterior& posterior,
                  Index n, const StreamId& id);

/// The mixture that propose() draws u from when the loss is analytic.
GaussianMixture proposal_mixture(const DirectPosterior& posterior);

}  // namespace npdr::inference
