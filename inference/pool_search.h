/// What NPE has missed of NLE's posterior, pi(u) = N(u; 0, I) l(z_o | u) / Z: places where pi is far
/// above q, as a mode that q hasn't learned of few simulations. Draws of q can't tell, since there
/// are none (weight_search.h looks for it from draws of q and of the prior).
#pragma once

#include <functional>
#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "inference/samplers/importance_state.h"

namespace npdr::inference {

/// Result of a search. Without places, q has missed nothing.
struct PoolSearch {
  ImportanceProposal places;  ///< densities around what was found
  double log_evidence = 0.0;  ///< log Z, of what q and the places hold [nats]
  double missed = 0.0;        ///< share of pi that lies where q is less than a quarter of it
};

/// log q(u) / p(u) and log l(z_o | u) of the rows of u (n, D), (n) each.
struct PoolDensities {
  Vector posterior;
  Vector likelihood;
};

/// u (n, D): draws of q. It depends on the arguments alone.
PoolSearch search_beyond(const RowMatrix& u,
                         const std::function<PoolDensities(const RowMatrix& u)>& densities,
                         const StreamId& id);

}  // namespace npdr::inference
