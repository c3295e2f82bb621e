/// Mixture density network: a mixture of Gaussians whose parameters are a network of the context.
///
/// Source: Bishop 1994, "Mixture density networks", eqs. 22-24, with full covariances:
///   log q(u | c) = logsumexp_k [ log softmax_k(l(c)) + log N(u; mu_k(c), (U_k(c)^T U_k(c))^-1) ],
///   log N = sum_i log U_ii - |U (u - mu)|^2 / 2 - D log(2 pi) / 2.
/// U is upper triangular; its diagonal is softplus(a + a_0) + 1e-3, 1 at a = 0. The trunk has tanh
/// layers. Head columns are grouped by quantity, K columns each: logits; D means; D (D + 1) / 2
/// entries U_ij, i <= j, row by row. The values of a column lie beside each other, so that loops
/// run over contexts.
#pragma once

#include <vector>

#include "inference/estimators/density_estimator.h"
#include "inference/estimators/gaussian_mixture.h"

namespace npdr::inference {

/// Memory of a pass of a mixture density network. n contexts, m = n k rows of u: row g k + a of u,
/// which belongs to context g, is row a n + g here.
template <typename S>
struct MixtureScratch : EstimatorScratch {
  std::vector<RowMatrixX<S>> hidden;  ///< L x (n, hidden)
  ColumnMatrixX<S> heads;             ///< (n, Q K): log weights, means, factors with their diagonal
  ColumnMatrixX<S> d_heads;           ///< (n, Q K): dL/d(those)
  RowMatrixX<S> d_hidden, d_below;
  ColumnMatrixX<S> points;          ///< (m, D): u
  ColumnMatrixX<S> deviation;       ///< (n, D): u - mu of one component, the points of one a;
                                    ///< (m, D) where n is 1
  ColumnMatrixX<S> whitened;        ///< (m, K D): U (u - mu), D columns for each component
  ColumnMatrixX<S> responsibility;  ///< (m, K)
};

template <typename S>
class MixtureDensityNetwork : public DensityEstimator<S> {
 public:
  /// Throws InputError for sizes below 1.
  MixtureDensityNetwork(const EstimatorConfig& config, Index dimension, Index context_features,
                        ParameterLayout& layout);

  Index dimension() const override { return dimension_; }
  Index context_features() const override { return context_features_; }
  Index num_components() const { return components_; }
  void initialize(Parameters<S>& parameters, Stream& stream) const override;
  std::unique_ptr<EstimatorScratch> make_scratch() const override;
  void log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                const RowMatrixX<S>& context, EstimatorScratch& scratch,
                VectorX<S>& log_prob) const override;
  void backward(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                const RowMatrixX<S>& context, const VectorX<S>& d_log_prob,
                EstimatorScratch& scratch, Parameters<S>& gradient,
                RowMatrixX<S>* d_context) const override;
  RowMatrixX<S> sample(const Parameters<S>& parameters, const RowMatrixX<S>& context, Index count,
                       const StreamId& id) const override;

  /// `parameters` become those of `single`, a network of one component, copied for every component:
  /// all that comes before the head as it is, the head's columns disturbed so that components can
  /// become different (component_growth.h).
  void grow(const MixtureDensityNetwork& single, const Parameters<S>& single_parameters,
            double perturbation, Parameters<S>& parameters, Stream& stream) const;

  /// Fills scratch.heads with the mixtures of all contexts.
  void forward_heads(const Parameters<S>& parameters, const RowMatrixX<S>& context,
                     MixtureScratch<S>& scratch) const;
  /// Overwrites scratch.d_heads with dL/d(log weights, means, factors) for dL/dlog_prob (m), after
  /// log_prob().
  void accumulate_heads(const VectorX<S>& d_log_prob, MixtureScratch<S>& scratch) const;
  /// Adds the gradient of the weights, given scratch.d_heads.
  void backward_heads(const Parameters<S>& parameters, const RowMatrixX<S>& context,
                      MixtureScratch<S>& scratch, Parameters<S>& gradient,
                      RowMatrixX<S>* d_context) const;
  /// Row n of scratch.heads as a mixture.
  GaussianMixture mixture(const MixtureScratch<S>& scratch, Index n) const;

  /// Column of scratch.heads where the K values of a quantity begin.
  Index weight_column() const { return 0; }
  Index mean_column(Index i) const { return (1 + i) * components_; }
  Index factor_column(Index i, Index j) const;  ///< i <= j

 private:
  Index num_columns() const;
  template <int kStride>
  void add_log_densities(Index component, Index first, Index count,
                         MixtureScratch<S>& scratch) const;
  void add_gradient(Index component, Index first, const VectorX<S>& weight,
                    MixtureScratch<S>& scratch) const;

  Index dimension_;
  Index context_features_;
  Index components_;
  std::vector<Block> weights_;  ///< trunk layers, then the head
  std::vector<Block> biases_;
};

}  // namespace npdr::inference
