/// Gaussian steps of ABC's proposals, in the space of u.
#pragma once

#include <Eigen/Cholesky>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// N(0, covariance) in D dimensions. Const calls are thread-safe.
class StepKernel {
 public:
  /// Throws InputError unless the covariance is that of `dimension` parameters, and Error unless it
  /// is positive definite: particles in fewer dimensions than there are parameters.
  StepKernel(const Eigen::MatrixXd& covariance, Index dimension);

  Vector sample(Stream& stream) const;
  /// log N(step; 0, covariance) of each row of steps (n, D), in nats.
  Vector log_density(const RowMatrix& steps) const;

 private:
  Eigen::MatrixXd factor_;  ///< lower
};

}  // namespace npdr::inference
