/// Search for places that a density q gives too little: where
///   w(u) = N(u; 0, I) L(u)^a / q(u)
/// is large though much of the posterior is there, as in a mode that q hasn't seen, or where a
/// ridge goes on beyond q.
///
/// It begins at the local maxima of w among points whose likelihood is known: those with a larger w
/// than the 12 points nearest to them (topographical global optimization, Torn and Viitanen 1994).
/// From each a searcher of its own makes Metropolis steps on w, of a covariance that follows the
/// steps that were taken (as in the (1+1)-CMA-ES, Igel, Suttorp and Hansen 2006) and of a length
/// that is adapted until a quarter of them is: it climbs, and then walks where w is large. Where q
/// knows a mode, w is flat and lower, so none is drawn to it.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "inference/samplers/flow_proposal.h"

namespace npdr::inference {

struct WeightSearch {
  RowMatrix u;            ///< (S, D) where the searchers are
  Vector log_likelihood;  ///< (S) there [nats], finite
  Vector log_weight;      ///< (S) log w there [nats], finite
  Vector log_step;        ///< (S) logarithm of the steps' length
  RowMatrix covariance;   ///< (S, D * D) of their steps, in units of that length
  Index num_steps = 0;    ///< that each has made
};

/// What the searches of a sampler have done.
struct SearchCounts {
  Index num_started = 0;  ///< places where searchers began
  Index num_found = 0;    ///< places where they have found something
};

/// Steps that a search makes in D dimensions.
Index num_search_steps(Index dimension);

/// Up to `most` searchers at points u (n, D), those of the largest w of all local maxima; fewer, or
/// none, where there are fewer. Rows without a finite likelihood and weight count for nothing.
WeightSearch begin_search(const RowMatrix& u, const Vector& log_likelihood,
                          const Vector& log_weight, Index most);

/// Where they may go next, (S, D).
RowMatrix propose_search_steps(const WeightSearch& search, const StreamId& id);
/// Accepts or rejects these places by log L and log w there, (S) each; NaN is -infinity.
void take_search_steps(WeightSearch& search, const RowMatrix& proposed,
                       const Vector& log_likelihood, const Vector& log_weight, const StreamId& id);

/// Student's t around each searcher that has found something: a part of the posterior of at least
/// kLeastFound, by the density where the searcher is and the volume that it walks in, of which q
/// has less than a quarter. One for those that have found the same; most of them first.
std::vector<FlowProposal> found_places(const WeightSearch& search, double power,
                                       double log_evidence);

}  // namespace npdr::inference
