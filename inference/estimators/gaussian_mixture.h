/// Mixtures of Gaussians in double precision: proposals, and the algebra of their corrections.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// p(u) = sum_k exp(log_weight_k) N(u; mean_k, (U_k^T U_k)^-1), U_k upper triangular with a
/// positive diagonal: the Cholesky factor of the precision.
struct GaussianMixture {
  Vector log_weights;                              ///< (K), normalized
  std::vector<Vector> means;                       ///< K x (D)
  std::vector<Eigen::MatrixXd> precision_factors;  ///< K x (D, D)

  Index num_components() const { return log_weights.size(); }
  Index dimension() const { return means.front().size(); }
  Eigen::MatrixXd precision(Index k) const;

  /// log p(u), u: (n, D).
  Vector log_prob(const RowMatrix& u) const;
  /// (n, D). Sample i has the stream of row id.row + i.
  RowMatrix sample(Index n, StreamId id) const;
};

/// The factor U of the precision U^T U of a covariance (D, D).
Eigen::MatrixXd precision_factor(const Eigen::MatrixXd& covariance);

/// The mixture with every component made at least as narrow as the prior N(0, I) in every
/// direction: eigenvalues of the precision below 1 become 1. Drawing from such a proposal keeps the
/// correction below well defined: precision_k + precision_j - I stays positive definite.
GaussianMixture narrower_than_prior(const GaussianMixture& mixture);

/// Components of a smaller weight don't count in a division.
inline constexpr double kLeastDividedWeight = 1e-4;

/// The posterior mixture q(u) N(u; 0, I) / p~(u), where `mixture` q is the posterior of simulations
/// that were drawn from the Gaussian `proposal` p~ (one component) instead of the prior N(0, I)
/// (Papamakarios and Murray 2016, eqs. 10-13). Per component, with precisions P_k and S and means
/// m_k and m,
///   Lambda = P_k - S,   eta = P_k m_k - S m,   P'_k = I + Lambda,   m'_k = P'_k^-1 eta.
/// Lambda is what the data say, so it has no negative eigenvalues; an estimate may have some, and
/// then no Gaussian is left (their paper stops there). Along such directions the data are taken to
/// say nothing: eigenvalue and eta become 0, q_k is as wide as p~, the prior remains. Weights are
/// those of what q_k is then: proportional to w_k times the integral of q_k N(0, I) / p~.
/// Components that say next to nothing of q (kLeastDividedWeight) are left out: in the tails of p~
/// its quotient could make everything of them. Weights sum to 1 and one of K is at least 1 / K, so
/// some are left.
GaussianMixture corrected_for_proposal(const GaussianMixture& mixture,
                                       const GaussianMixture& proposal);

}  // namespace npdr::inference
