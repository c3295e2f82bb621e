/// ABC by population Monte Carlo: rounds of importance sampling with a shrinking threshold.
///
/// Sources: Beaumont, Cornuet, Marin and Robert 2009, "Adaptive approximate Bayesian computation",
/// section 3; Toni et al. 2009, "Approximate Bayesian computation scheme for parameter inference
/// and model selection in dynamical systems"; Filippi et al. 2013 for kernels of full covariance.
/// Proposals of round t are particles of round t - 1, drawn by weight and moved by N(0, K), K twice
/// their weighted covariance. Those within epsilon_t are the new population, with weights
///   w_i ~ p(u_i) / sum_j w_j^(t-1) N(u_i; u_j^(t-1), K),        p = N(0, I).
/// epsilon_t is a quantile of the distances of population t - 1, but at least config.epsilon.
/// A round makes N proposals rather than as many as it takes to accept N.
#pragma once

#include "core/random.h"
#include "inference/abc/abc_config.h"
#include "inference/abc/population.h"
#include "inference/prior.h"

namespace npdr::inference {

/// K for the proposals of the round after `population`, (D, D).
Eigen::MatrixXd twice_the_covariance(const Prior& prior, const AbcPopulation& population);

/// (n, D) particles, moved.
RowMatrix propose_moved(const Prior& prior, const AbcPopulation& population, Index n,
                        const StreamId& id);

/// A round after the first. Throws Error when too few simulations are accepted.
AbcPopulation next_population(const AbcConfig& config, const Prior& prior, const AbcRound& round,
                              const AbcPopulation& previous);

}  // namespace npdr::inference
