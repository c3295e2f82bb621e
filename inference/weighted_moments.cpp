#include "inference/weighted_moments.h"

namespace npdr::inference {

double effective_size(const Vector& weights) {
  const double sum = weights.sum();
  return sum * sum / weights.squaredNorm();
}

Vector weighted_mean(const RowMatrix& x, const Vector& weights) {
  return x.transpose() * weights / weights.sum();
}

Eigen::MatrixXd weighted_covariance(const RowMatrix& x, const Vector& weights) {
  const RowMatrix centered = x.rowwise() - weighted_mean(x, weights).transpose();
  const double sum = weights.sum();
  return centered.transpose() * weights.asDiagonal() * centered /
         (sum - weights.squaredNorm() / sum);
}

Eigen::MatrixXd regularized_covariance(const RowMatrix& x, const Vector& weights) {
  Eigen::MatrixXd covariance = weighted_covariance(x, weights);
  covariance.diagonal().array() += 1e-12 + 1e-9 * covariance.diagonal().array();
  return covariance;
}

}  // namespace npdr::inference
