/// Local classifier two-sample test: is the posterior right at this one observation?
///
/// Source: Linhart, Gramfort and Rodrigues 2023, "L-C2ST: local diagnostics for posterior
/// approximations in simulation-based inference", algorithms 1-2. A classifier learns to tell pairs
/// (theta_i, x_i) of the simulator from pairs (theta'_i, x_i) with theta'_i drawn from the
/// posterior at x_i. Were the posterior right, it could say nothing, d = 1/2 everywhere; the
/// statistic at x_o is
///   t = mean over samples theta of the posterior at x_o of (d(theta, x_o) - 1/2)^2.
/// The null distribution: the same with theta_i and theta'_i exchanged in a random half of the
/// pairs, which changes nothing when the posterior is right; the classifier is trained anew each
/// time.
#pragma once

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Settings of the test.
struct LocalC2stConfig {
  Index num_trials = 200;     ///< under the null hypothesis
  Index max_epochs = 100;     ///< of each training: the null allows any classifier
  Index max_components = 10;  ///< of x that the classifier sees
};

/// Result of the test at one observation.
struct LocalC2st {
  double statistic = 0.0;  ///< t; 0: can't be told apart, 1/4: certainly told apart
  Vector null;             ///< (num_trials) t under the null hypothesis
  double p_value = 1.0;    ///< tail_probability.h
};

/// Data that the test compares; all u where the prior is N(0, I).
struct LocalC2stData {
  RowMatrix u;          ///< (n, D) parameters of the simulations
  RowMatrix u_sampled;  ///< (n, D) a posterior sample for each of them
  RowMatrixF x;         ///< (n, F)
  RowMatrix u_at_x_o;   ///< (m, D) posterior samples at x_o
  VectorF x_o;          ///< (F)
};

/// Trials run in parallel; the bits don't depend on the number of threads. Throws ShapeError when
/// shapes don't go together and InputError for fewer than kFewestSimulations.
LocalC2st local_c2st(const LocalC2stData& data, const StreamId& id,
                     const LocalC2stConfig& config = {});

}  // namespace npdr::inference
