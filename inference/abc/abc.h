/// Approximate Bayesian computation: simulations near the observation are samples of the posterior,
///   p(theta | d(x, x_o) <= epsilon).
///
/// | algorithm     | proposals                         | source                              |
/// | abc_rejection | the prior                         | Pritchard et al. 1999               |
/// | abc_mcmc      | a step of each of N Markov chains | Marjoram et al. 2003 (abc_mcmc.h)   |
/// | abc_smc       | the last population, moved        | Beaumont et al. 2009 (abc_smc.h)    |
///
/// All of them begin with N simulations of the prior, of which those within epsilon (acceptance.h)
/// are the first population. Steps are taken in the space of u, where the prior is N(0, I)
/// (prior.h): no proposal leaves the prior's support.
#pragma once

#include <optional>

#include "core/random.h"
#include "inference/abc/abc_config.h"
#include "inference/abc/population.h"
#include "inference/algorithms/algorithm_config.h"
#include "inference/prior.h"

namespace npdr::inference {

/// The population after a round: `previous` is that of the round before, none in round 1, which
/// `round`'s proposals were drawn from. `id` names seed and round. Throws Error when too few
/// simulations are accepted.
AbcPopulation advance(Algorithm algorithm, const AbcConfig& config, const Prior& prior,
                      const AbcRound& round, const std::optional<AbcPopulation>& previous,
                      const StreamId& id);

/// (n, D) proposals for the round after `population`. Row i depends on `id` and i alone. Throws
/// InputError where there is nothing to propose: "abc_rejection" has one round, and Markov chains
/// propose as many as there are chains.
RowMatrix propose(Algorithm algorithm, const Prior& prior, const AbcPopulation& population, Index n,
                  const StreamId& id);

}  // namespace npdr::inference
