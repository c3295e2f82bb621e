/// "npe_nle", the default method: NPE and NLE, pooled.
///
///  1. Simulations of round 1 come from the prior.
///  2. Those of later rounds come from the prior where the last posterior is (truncated_prior.h).
///  3. Two ensembles of networks learn from them by maximum likelihood, q(u | z) and l(z | u).
///  4. q learns from the simulations of all rounds in the last region, weighted as draws of the
///     prior.
///  5. l, to which proposals don't matter, learns from all of them.
///  6. l sees the features of q or, where they are many, the few that tell something, or principal
///     components (untrained_likelihood()).
///  7. A twentieth of the last round's simulations, 300 at most, teaches neither.
///  8. These judge the powers a and b of the pool p(u) (q(u | z) / p(u))^a l(z | u)^b
///     (pool_powers.h).
///  9. The posterior is the pool at x_o, sampled by importance from q (pooled_posterior.h).
/// 10. Where q and l contradict each other at x_o, as when it is like no simulation, powers move
///     towards those of q alone.
#pragma once

#include "inference/algorithms/round_task.h"

namespace npdr::inference {

inline constexpr Index kMostPooledFeatures = 50;
inline constexpr Index kPooledComponents = 20;

/// The rows that q, l and the powers learn from. `are_pooled`: powers are judged.
LearnedRows rows_of_npe_nle(const RoundData& data, bool are_pooled);

/// The likelihood networks, all but the weights. Of more than kMostPooledFeatures features they see
/// the informative_features(), or kPooledComponents principal components where those are more, too;
/// components also where the posterior has trained layers, whose outputs have no density. Given
/// theta, components are sums of noise and nearly normal: where the posterior has splines ("nsf"),
/// their likelihood has affine maps ("maf"), which say as much of fresh simulations, sooner, and
/// are better where no simulation is like the observation. `posterior`: the networks that they are
/// pooled with, at least one of whose features varies.
PooledLikelihood untrained_likelihood(const PosteriorEstimationConfig& config,
                                      const RoundData& data, const NetworkParts& posterior);

/// (n, D) proposals of theta for the next round.
RowMatrix propose_for_npe_nle(const NetworkPosterior& posterior, Index n, const StreamId& id);

}  // namespace npdr::inference
