/// A normalizing flow that is fitted to weighted points: a density to draw from.
///
/// u = m + L v, with the mean m and the Cholesky factor L of the points' covariance. A share of 0.9
/// of g(u) is a neural spline flow z = f(v) (maf.h),
///   log N(f(v); 0, I) + log |det df/dv| - log |L|,
/// trained by maximum likelihood, with a validation split and early stopping, in some seconds for
/// twenty thousand points. The rest is Student's t with 5 degrees of freedom around m, with L as
/// its scale: a flow has learned nothing of where no points are, and falls too fast.
#pragma once

#include <memory>

#include "core/random.h"
#include "core/types.h"
#include "inference/estimators/maf.h"

namespace npdr::inference {

/// A fitted flow, as a file holds it.
struct FlowParts {
  Vector mean;             ///< (D)
  RowMatrix factor;        ///< (D, D) lower
  Parameters<float> flow;  ///< weights of the network
};

/// Const calls are thread-safe.
class FlowReference {
 public:
  /// Fits the rows of u (n, D), n >= 10, with weights (n) > 0, from the network `start` (empty: a
  /// fresh one). The fit depends on the arguments alone. Throws InputError for too few rows.
  FlowReference(const RowMatrix& u, const Vector& weights, const Parameters<float>& start,
                const StreamId& id);
  /// Throws ShapeError when the parts don't go together.
  explicit FlowReference(FlowParts parts);

  const FlowParts& parts() const { return *parts_; }
  Index dimension() const { return parts_->mean.size(); }

  /// log g of each row of u (n, D), (n) [nats]; of Student's t alone where the network overflows.
  Vector log_density(const RowMatrix& u) const;
  /// (n, D) draws of g; row i has the stream of row id.row + i.
  RowMatrix sample(Index n, const StreamId& id) const;

 private:
  void build(Index dimension);

  std::shared_ptr<const FlowParts> parts_;  // which copies have in common
  Index num_parameters_ = 0;
  std::shared_ptr<const MaskedAutoregressiveFlow<float>> flow_;
};

}  // namespace npdr::inference
