/// Mixtures of Gaussians in double precision: proposals, and the algebra of their corrections.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// p(u) = sum_k exp(log_weight_k) N(u; mean_k, (U_k^T U_k)^-1), U_k upper triangular with a
/// positive diagonal: the Cholesky factor of the precision.
struct GaussianMixture {
  Vector log_weights;                              ///< (K), normalised
  std::vector<Vector> means;                       ///< K x (D)
  std::vector<Eigen::MatrixXd> precision_factors;  ///< K x (D, D)

  Index num_components() const { return log_weights.size(); }
  Index dimension() const { return means.front().size(); }
  Eigen::MatrixXd precision(Index k) const;

  /// log p(u), u: (n, D).
  Vector log_prob(const RowMatrix& u) const;
  Vector sample(Stream& stream) const;
};

/// The mixture with every component made at least as narrow as the prior N(0, I) in every
/// direction: eigenvalues of the precision below 1 become 1. Drawing from such a proposal keeps the
/// correction below well defined: precision_k + precision_j - I stays positive definite.
GaussianMixture narrower_than_prior(const GaussianMixture& mixture);

/// log sum_i exp(values_i) without overflow.
double log_sum_exp(const Vector& values);

}  // namespace npdr::inference
