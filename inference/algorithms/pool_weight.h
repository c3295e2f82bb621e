/// The weight of NLE in a pool with NPE (pooled_posterior.h): of a = 0, 0.05, ..., 1 the one with
/// the largest mean log density of parameters that the networks haven't been trained on,
///   1/n sum_i log p_a(u_i | x_i) = const + 1/n sum_i [a r_i0 - log 1/(K + 1) sum_k exp(a r_ik)],
///   r_ik = log l(z_i | u_ik) N(u_ik; 0, I) / q(u_ik | z_i),
/// a concave function of a. u_i0 = u_i, a draw of the posterior given x_i as it is in simulations
/// of the prior; u_i1, ..., u_iK are draws of q: the sum stands for the pool's normalizing
/// constant. Rows of network m are those that validated it, and its own q and l are compared.
#pragma once

#include "inference/algorithms/posterior_estimation.h"

namespace npdr::inference {

/// Simulations must be those of the prior. `posterior`, `likelihood`: trained, of as many networks.
double pool_weight(const NetworkParts& posterior, const NetworkParts& likelihood,
                   const RoundData& data, const TrainingConfig& training, const StreamId& id);

}  // namespace npdr::inference
