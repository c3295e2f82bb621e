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
  const RowMatrix centred = x.rowwise() - weighted_mean(x, weights).transpose();
  const double sum = weights.sum();
  return centred.transpose() * weights.asDiagonal() * centred / (sum - weights.squaredNorm() / sum);
}

}  // namespace npdr::inference
