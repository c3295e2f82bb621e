/// The analytic proposal correction of NPE-C for mixtures of Gaussians.
///
/// Source: Greenberg, Nonnenmacher and Macke 2019, eqs. 3-4 and appendix A.1. The simulations were
/// drawn from a proposal mixture p~(u); the density that the network should match is
///   q~(u | x) = q(u | x) p~(u) / p(u) / Z(x),     loss = -log q~(u | x),
/// with the prior p(u) = N(0, I) (prior.h). With component precisions P_k of q and R_j of p~,
///   Z = sum_kj a_k b_j exp(g_kj),   A = P_k + R_j - I,   v = A^-1 (P_k mu_k + R_j m_j),
///   g_kj = (log|P_k| + log|R_j| - log|A| - mu_k' P_k mu_k - m_j' R_j m_j + v' A v) / 2.
/// A is positive definite because the proposal is narrower_than_prior(). The terms log p~ and
/// log p don't depend on the network and are left out of the loss.
#pragma once

#include <vector>

#include "core/types.h"
#include "inference/estimators/gaussian_mixture.h"

namespace npdr::inference {

/// Gradient of a scalar with respect to the parameters of a mixture.
struct GaussianMixtureGradient {
  Vector log_weights;                              ///< (K)
  std::vector<Vector> means;                       ///< K x (D)
  std::vector<Eigen::MatrixXd> precision_factors;  ///< K x (D, D), upper triangle
};

/// log Z for q and the proposal, and its gradient with respect to q's parameters.
double log_normaliser(const GaussianMixture& q, const GaussianMixture& proposal,
                      GaussianMixtureGradient& gradient);

}  // namespace npdr::inference
