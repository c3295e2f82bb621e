#include "inference/policy_search/exploration.h"

#include "core/decompositions.h"
#include "core/error.h"

namespace npdr::inference {

RowMatrix scatter_around(const Vector& center, const RowMatrix& x, const Vector& weights) {
  const RowMatrix steps = x.rowwise() - center.transpose();
  return steps.transpose() * weights.asDiagonal() * steps / weights.sum();
}

RowMatrix with_min_std(const RowMatrix& covariance, double min_std) {
  const SymmetricEigen eigen(covariance);
  const Vector variances = eigen.values.cwiseMax(min_std * min_std);
  const RowMatrix bounded = eigen.vectors * variances.asDiagonal() * eigen.vectors.transpose();
  return 0.5 * (bounded + bounded.transpose());
}

RowMatrix draw_gaussian(const Vector& mean, const RowMatrix& covariance, Index n,
                        const StreamId& id) {
  const Cholesky factor(covariance);
  if (!factor.is_positive_definite()) {
    throw Error("policy search: the covariance of the exploration isn't positive definite");
  }
  RowMatrix draws(n, mean.size());
  for (Index i = 0; i < n; ++i) {
    StreamId row = id;
    row.row = static_cast<std::uint64_t>(i);
    Stream stream(row);
    Vector z(mean.size());
    for (double& value : z) value = stream.normal();
    draws.row(i) = (mean + factor.times(z)).transpose();
  }
  return draws;
}

}  // namespace npdr::inference
