/// A normalizing flow that is fitted to weighted points: a density to draw from.
///
/// u = m + L v, with the mean m and the Cholesky factor L of the points' covariance. A share of 0.9
/// of g(u) is a neural spline flow z = f(v) (maf.h),
///   log N(f(v); 0, I) + log |det df/dv| - log |L|,
/// trained by maximum likelihood, with a validation split and early stopping, in some seconds for
/// twenty thousand points. The rest is Student's t with 5 degrees of freedom around m, with L as
/// its scale: a flow has learned nothing of where no points are, and falls too fast.
#pragma once

#include "core/random.h"
#include "core/types.h"
#include "inference/estimators/parameters.h"

namespace npdr::inference {

/// A fitted flow g. Const calls are thread-safe.
struct FlowProposal {
  Vector mean;                ///< (D)
  RowMatrix factor;           ///< (D, D) lower
  Parameters<float> network;  ///< weights of f; empty: Student's t alone

  Index dimension() const { return mean.size(); }
  /// Throws ShapeError when the parts don't go together.
  void check() const;
  /// log g of each row of u (n, D), (n) [nats]; of Student's t alone where the network overflows.
  Vector log_density(const RowMatrix& u) const;
  /// (n, D) draws of g; row i has the stream of row id.row + i.
  RowMatrix sample(Index n, const StreamId& id) const;

  bool operator==(const FlowProposal& other) const;
};

/// The fit to the rows of u (n, D), n > D, with weights (n) > 0, from the network `start` (empty:
/// a fresh one); Student's t alone for fewer than 10 rows. It depends on the arguments alone.
/// Throws InputError for points without a covariance.
FlowProposal fit_flow(const RowMatrix& u, const Vector& weights, const Parameters<float>& start,
                      const StreamId& id);

}  // namespace npdr::inference
