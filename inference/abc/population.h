/// Result of a round of approximate Bayesian computation.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Weighted particles, and what the next round's proposals are drawn from.
struct AbcPopulation {
  RowMatrix theta;         ///< (n, D)
  Vector weights;          ///< (n), their sum is 1
  Vector distances;        ///< (n)
  double epsilon = 0.0;    ///< threshold that all distances keep
  Eigen::MatrixXd kernel;  ///< (D, D) covariance of the step to a proposal, in the space of u
  Index num_chains = 0;    ///< C > 0: draw s of Markov chain c is row s C + c
};

/// One round's simulations, the failed ones among them, at an infinite distance.
struct AbcRound {
  RowMatrix theta;   ///< (N, D)
  Vector distances;  ///< (N)
};

}  // namespace npdr::inference
