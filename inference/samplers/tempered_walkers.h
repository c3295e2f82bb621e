/// Walkers that climb from a low power of the likelihood to a higher one.
///
/// A population of walkers stands for
///   pi_b(u) = N(u; 0, I) L(u)^b / Z_b
/// and climbs by sequential Monte Carlo (Neal 2001; Del Moral, Doucet and Jasra 2006). A raise goes
/// to the largest b' at which enough walkers are effective by their weights L(u)^(b' - b), and
/// draws them anew by those. Between raises they walk: in a sweep each makes one Metropolis step.
/// A wide one goes to
///   u + g (u_j - u_k)  with two others (ter Braak 2006), or  N(u, g^2 C),
/// half of the time each; C is the walkers' covariance. A near one goes to the former with two of
/// the walker's neighbors: where modes lie apart, only they tell the shape of its own. Neighbors
/// are the 30 nearest when they were chosen last, in units of the walkers' deviations; in between
/// they stay the same, so that steps there and back are as likely, but for the first one. g
/// is 2.38 / sqrt(2 D) or 2.38 / sqrt(D), times a step length of its kind that is adapted until a
/// fifth of the steps is taken, times exp(N(0, 1/4)). All walk at once, and C, neighbors and step
/// lengths follow them, so they have the law of pi_b only nearly. They are there to teach, not to
/// be reported.
#pragma once

#include <array>
#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Kind of the steps of a sweep.
enum class StepKind { wide, near };

struct TemperedWalkers {
  RowMatrix u;                                      ///< (W, D)
  Vector log_likelihood;                            ///< (W) [nats], finite
  double power = 0.0;                               ///< b
  double log_evidence = 0.0;                        ///< log Z_b [nats]
  std::array<double, 2> step_lengths = {1.0, 1.0};  ///< by StepKind
  Index num_sweeps = 0;                             ///< at this power
  RowMatrixX<Index> neighbors = {};  ///< (W, k) which walkers they are; empty: not chosen yet
};

/// The largest power up to `most` at which as many walkers are effective; theirs: none is.
double next_power(const TemperedWalkers& walkers, double most, double num_effective);
/// Moves to that power, and log Z with it. Afterwards there are `count` walkers, without neighbors;
/// returns which of the former ones each of them was.
std::vector<Index> raise_power(TemperedWalkers& walkers, double power, Index count,
                               const StreamId& id);

/// Chooses the neighbors of each by where they are now: the 30 nearest, or all others.
void choose_neighbors(TemperedWalkers& walkers);

/// Proposed places of the walkers (three or more), (W, D). Throws ShapeError for near steps without
/// neighbors.
RowMatrix propose_steps(const TemperedWalkers& walkers, StepKind kind, const StreamId& id);
/// Accepts or rejects these places by their log likelihoods (W); NaN is -infinity.
void take_steps(TemperedWalkers& walkers, StepKind kind, const RowMatrix& proposed,
                const Vector& log_likelihood, const StreamId& id);

}  // namespace npdr::inference
