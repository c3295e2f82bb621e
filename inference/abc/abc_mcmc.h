/// ABC by Markov chains, many side by side.
///
/// Source: Marjoram, Molitor, Plagnol and Tavare 2003, "Markov chain Monte Carlo without
/// likelihoods", algorithm F. From u, a chain proposes u' = u + N(0, K) and goes there if the
/// simulation at u' is within epsilon and a uniform number is below p(u') / p(u), p = N(0, I).
///
/// Here all chains take one step a round, so that N simulations are made at once. They begin at
/// draws of the first population, which is distributed as they should be: epsilon is that of round
/// 1 throughout, and K = 2.38^2 / D times the first population's covariance (Roberts, Gelman and
/// Gilks 1997). After r rounds the particles are the chains' draws of the later half of them,
/// rounds floor(r / 2) + 1 to r.
#pragma once

#include "core/random.h"
#include "inference/abc/population.h"
#include "inference/prior.h"

namespace npdr::inference {

/// Round 1: `num_chains` chains. The stream of chain c is row c of `id`.
AbcPopulation start_chains(const Prior& prior, const AbcPopulation& first, Index num_chains,
                           const StreamId& id);

/// (n, D) proposal of each chain. Throws InputError unless there are n chains.
RowMatrix propose_chain_steps(const Prior& prior, const AbcPopulation& population, Index n,
                              const StreamId& id);

/// Round id.round > 1, whose simulations are at the proposals of `previous`.
AbcPopulation advance_chains(const Prior& prior, const AbcRound& round,
                             const AbcPopulation& previous, const StreamId& id);

}  // namespace npdr::inference
