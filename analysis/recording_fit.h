/// A least-squares fit of a recording whose first states are as noisy as all others.
///
/// Errors e are recorded minus simulated stored states, over the standard deviation sigma of the
/// noise of their rollout and channel: H rollouts of K states of C channels. Simulations begin in
/// recorded first states y_0, one a segment, whose noise moves all that follows. So
///   min over theta, x_0 of sum e^2 + sum ((y_0 - x_0) / sigma)^2
/// has first states x_0 of its own, which are eliminated from the normal equations: each is in the
/// errors of its own segment only.
#pragma once

#include <functional>

#include "core/target.h"
#include "core/types.h"

namespace npdr::analysis {

/// Simulated stored states (n, H K C) of rows of theta (n, D) that replay a target in segments of
/// that many steps; a row that failed isn't finite.
using Replay =
    std::function<RowMatrix(const Target& target, Index segment_length, const RowMatrix& theta)>;

/// Segments of a rollout that a fit begins with, of a simulator that can begin anywhere.
inline constexpr Index kFitParts = 16;

/// How recordings are fitted. References must outlive it.
struct FitProblem {
  const Replay& replay;
  Vector lower, upper;       ///< (D) the box of theta
  RowMatrix sigma;           ///< (H, C) standard deviation of the noise, > 0
  Index store_every = 1;     ///< as of `replay`
  Index segment_length = 0;  ///< [steps] the longest; 0: the whole rollout
  Index parts = kFitParts;   ///< 1: `replay` can't cut rollouts
};

struct Fit {
  RowMatrix errors;          ///< (H K, C), over sigma; empty: no fit was found
  Vector theta;              ///< (D)
  RowMatrix first_states;    ///< (H segments, C) y_0 - x_0, over sigma
  Index segment_length = 0;  ///< [steps]
};

/// [steps] of the segments that a fit begins with: a whole number of stored states.
Index first_length(const FitProblem& problem, const Target& recording);

/// Gauss and Newton's steps (Nocedal and Wright 2006, ch. 10.3), each halved until it helps, from
/// `theta` and recorded first states. Motion that forks can't be fitted at once (Bock 1983): at
/// first segments are a sixteenth of a rollout, then twice as long, as long as the fits converge: a
/// further step would take away less than 3 % of the errors' root mean square. The last of these
/// counts; where none converges, the first that can be simulated.
Fit fit(const FitProblem& problem, const Target& recording, const Vector& theta);

/// The errors that a step from a fit of another recording would leave were simulations linear;
/// empty: the start can't be simulated.
RowMatrix errors_after_step(const FitProblem& problem, const Target& recording, const Fit& start);

}  // namespace npdr::analysis
