/// One round of neural inference: simulations of all rounds so far -> posterior.
///
///  - npe_nle: q(u | z) and l(z | u), both by maximum likelihood, pooled (npe_nle.h);
///  - npe_a: q(u | z), a mixture, by maximum likelihood on the last round's simulations; divided by
///    their proposal (likelihood_objective.h, gaussian_mixture.h);
///  - npe_b: q(u | z) by maximum likelihood weighted by p / p~ (likelihood_objective.h);
///  - npe_c: q(u | z) by the atomic or the analytic loss (npe_c.h);
///  - nle: q(z | u) by maximum likelihood (likelihood_objective.h);
///  - nre_a, nre_b: p(z | u) / p(z) by a binary or a categorical cross-entropy (ratio_objective.h).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "inference/algorithms/algorithm_config.h"
#include "inference/algorithms/npe_c.h"
#include "inference/direct_posterior.h"
#include "inference/estimators/trained_embedding.h"
#include "inference/training/trainer.h"

namespace npdr::inference {

/// Settings of neural inference.
struct PosteriorEstimationConfig {
  AlgorithmConfig algorithm;
  EstimatorConfig estimator;
  TrainingConfig training;
  SamplerConfig sampler;           ///< "nle", "nre_a", "nre_b"
  Index principal_components = 0;  ///< of x that the network sees, at most; 0: x itself
  TrainedEmbeddingConfig embedding = {};
  Tails tails = Tails::kept;  ///< of x
};

/// The simulations of all rounds so far, the failed ones left out, and what was observed.
struct RoundData {
  const Prior* prior = nullptr;
  const FeatureSource* x = nullptr;  ///< (N, F)
  RowMatrix theta;                   ///< (N, D)
  std::vector<std::uint32_t> round;  ///< (N), counted from 1
  VectorF x_o;                       ///< (F)
  /// Posteriors of the rounds before, which simulations of rounds 2, 3, ... were proposed from.
  std::vector<std::shared_ptr<const NetworkPosterior>> posteriors;
  /// (R) rows that each round simulated, failed ones too; empty: none has failed.
  std::vector<Index> num_simulated = {};
};

/// Called after every epoch of network m = 0, 1, ..., by one thread at a time; returns false to
/// stop that network's training here.
using NetworkHook = std::function<bool(Index m, const TrainingState&)>;

/// The hook that lets all trainings come to their end.
bool never_stop(Index m, const TrainingState& state);

/// Trains the networks of the estimator on `data`, each on a thread, from the weights and the
/// feature transform of the last round's posterior, or from scratch in round 1. `id` names the seed
/// and round. `states`: one a network, those of a likelihood after those of the posterior, or none;
/// a state that a hook kept goes on from there with the same bits, an empty one starts. Returns
/// nothing when the hook stopped a training. Throws ShapeError for the state of another network,
/// InputError for a density estimator that doesn't suit the algorithm.
std::unique_ptr<NetworkPosterior> estimate_posterior(const PosteriorEstimationConfig& config,
                                                     const RoundData& data, const StreamId& id,
                                                     std::vector<TrainingState>& states,
                                                     const NetworkHook& hook);

/// (n, D) proposals of theta for the next round, drawn from the posterior estimate; for "npe_nle"
/// from the prior where that is, for the analytic loss from a mixture that the loss can correct
/// for.
RowMatrix propose(const PosteriorEstimationConfig& config, const NetworkPosterior& posterior,
                  Index n, const StreamId& id);

}  // namespace npdr::inference
