/// The powers of NPE and NLE in their pool (pooled_posterior.h): of a, b = 0, 0.05, ..., a + b <= 2
/// those with the largest log density of parameters that no network has been trained on,
///   sum_i log p_{a,b}(u_i | z_i) - ((a + b - 1) / 0.3)^2 / 2 - ((a - b) / 0.3)^2 / 2,
///   log p_{a,b}(u_i | z_i) = log q(u_i | z_i) + w_i0 - log 1/(K + 1) sum_k exp(w_ik),
/// a concave function of a and b, with w the logs of the pool's weights of draws of q. u_i0 = u_i
/// is a draw of the posterior given x_i as it is in simulations of the prior, or of what later
/// rounds leave of it, u_i1, ..., u_iK are draws of q: their mean stands for the pool's normalizing
/// constant, over the region of later rounds (truncated_prior.h): draws beyond it weigh nothing.
/// The last terms are a prior that few simulations don't outweigh.
///
/// Where a + b > 1 is best, the smallest a + b >= 1 is taken whose best powers have at most 1/2 nat
/// less, prior included: by that the log density of a Gaussian falls within one standard deviation,
/// so the rows can't tell such sums apart (Wilks 1938). Few rows choose an a + b that is
/// too large as often as one that is too small, and posteriors that are too narrow are worse than
/// wide ones. a + b <= 1 alone was tried: with 1000 simulations posteriors were further from the
/// known ones, with 10,000 as close, and closer on a mixture of a wide and a narrow Gaussian, whose
/// weights sharpening shifts to the narrow one.
#pragma once

#include "inference/algorithms/posterior_estimation.h"

namespace npdr::inference {

/// How many of `num_rows` simulations judge the powers: the last ones.
Index num_judging_rows(Index num_rows);

/// `parts`: the networks of posterior and likelihood. `rows` of the data have trained none of them.
PoolPowers pool_powers(const NetworkParts& parts, const RoundData& data,
                       const std::vector<std::uint32_t>& rows, const StreamId& id);

}  // namespace npdr::inference
