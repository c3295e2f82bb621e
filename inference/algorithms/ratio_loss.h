/// Losses of ratio estimators, which learn to tell simulated pairs from others.
///
/// With k values of u for an x, the first one that of its simulation and the others those of other
/// simulations, and f the network's logits (ratio_estimator.h):
///  - "nre_a" (AALR; Hermans, Begy and Louppe 2020, algorithm 1), k = 2, binary cross-entropy:
///      loss = -log sigmoid(f_0) - log(1 - sigmoid(f_1)),
///    whose minimum is f = log p(x | u) / p(x);
///  - "nre_b" (SRE; Durkan, Murray and Papamakarios 2020, eq. 7), categorical cross-entropy:
///      loss = -log [ exp f_0 / sum_a exp f_a ],
///    whose minimum is that plus any function of x.
/// Simulations of later rounds don't come from the prior: u and x are then independent under their
/// own marginals, and f is still log p(x | u) but for a function of x.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Mean loss over n rows with two logits each, (2 n); `d_logits` receives dloss/dlogits.
template <typename S>
double binary_ratio_loss(const VectorX<S>& logits, VectorX<S>& d_logits);

/// Mean loss over n rows with k logits each, (n k); `d_logits` receives dloss/dlogits.
template <typename S>
double categorical_ratio_loss(const VectorX<S>& logits, Index k, VectorX<S>& d_logits);

}  // namespace npdr::inference
