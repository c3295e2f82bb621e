/// The analytic proposal correction of NPE-C for mixtures of Gaussians.
///
/// Source: Greenberg, Nonnenmacher and Macke 2019, eqs. 3-4 and appendix A.1. The simulations were
/// drawn from a proposal mixture p~(u); the density that the network should match is
///   q~(u | x) = q(u | x) p~(u) / p(u) / Z(x),     loss = -log q~(u | x),
/// with the prior p(u) = N(0, I) (prior.h). With component precisions P_k of q and R_j of p~,
///   Z = sum_kj a_k b_j exp(g_kj),   A = P_k + R_j - I,   v = A^-1 (P_k mu_k + R_j m_j),
///   g_kj = (log|P_k| + log|R_j| - log|A| - mu_k' P_k mu_k - m_j' R_j m_j + v' A v) / 2.
/// A is positive definite because the proposal is narrower_than_prior(). The terms log p~ and log p
/// don't depend on the network and are left out of the loss.
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

/// The correction for one proposal. Keeps R_j - I, R_j m_j and the constants of g_kj, with the
/// proposal's components side by side, so that the J products with a component of q are computed
/// together in vector registers. Not thread-safe: the products live in a scratch.
class MixtureCorrection {
 public:
  /// Every component of the proposal must be narrower_than_prior().
  explicit MixtureCorrection(const GaussianMixture& proposal);

  /// log Z for q, and, unless it is null, the gradient with respect to q's parameters.
  double log_normalizer(const GaussianMixture& q, GaussianMixtureGradient* gradient);

 private:
  /// Components of the proposal that are computed together.
  static constexpr Index kLanes = 8;
  using Lanes = Eigen::Array<double, kLanes, 1>;
  /// (D, D) or (D) of them, row by row.
  using LaneArray = std::vector<Lanes, Eigen::aligned_allocator<Lanes>>;

  /// kLanes components of the proposal; those that fill up the last block weigh nothing.
  struct Block {
    Lanes log_constant;  ///< log b_j + (log|R_j| - m_j' R_j m_j) / 2
    LaneArray precision_minus_identity;
    LaneArray precision_times_mean;
  };
  /// N(u; v, A^-1) for one component of q and one block.
  struct Product {
    Lanes log_mass;        ///< log a_k + log b_j + g_kj
    LaneArray mean;        ///< v, (D)
    LaneArray covariance;  ///< A^-1, (D, D), lower triangle
  };

  Lanes& at(LaneArray& matrix, Index row, Index col) const;
  void multiply(const Eigen::MatrixXd& factor, const Eigen::MatrixXd& precision, const Vector& mean,
                const Block& block, bool with_covariance, Product& product);
  void add_gradient(const GaussianMixture& q, Index k, double log_z,
                    GaussianMixtureGradient& gradient) const;

  Index dimension_;
  std::vector<Block> blocks_;
  std::vector<Product> products_;  ///< K x blocks
  LaneArray factor_;               ///< (D, D): the Cholesky factor of A
  LaneArray inverse_factor_;       ///< (D, D)
  LaneArray gap_;                  ///< (D): R_j m_j - (R_j - I) mu_k
};

}  // namespace npdr::inference
