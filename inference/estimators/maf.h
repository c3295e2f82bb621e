/// Masked autoregressive flows as conditional density estimators: "maf" with affine transforms,
/// "nsf" (neural spline flow) with splines.
///
/// Sources: Papamakarios, Pavlakou and Murray 2017, eqs. 3-6 and section 3.4 (conditional MAF);
/// Durkan et al. 2019, section 3.2 (RQ-NSF, autoregressive). With K transforms f_1..f_K
/// (autoregressive_transform.h), each after a permutation P_k of the variables,
///   z = f_K(P_K ... f_1(P_1 u)),   log q(u | c) = log N(z; 0, I) + sum_k log |det df_k|.
#pragma once

#include "inference/estimators/autoregressive_transform.h"
#include "inference/estimators/density_estimator.h"

namespace npdr::inference {

template <typename S>
class MaskedAutoregressiveFlow : public DensityEstimator<S> {
 public:
  /// Throws InputError for sizes that can't be.
  MaskedAutoregressiveFlow(const EstimatorConfig& config, Index dimension, Index context_features,
                           const StreamId& structure, ParameterLayout& layout);

  Index dimension() const override { return dimension_; }
  Index context_features() const override { return context_features_; }
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

 private:
  struct Scratch;

  Index num_transforms() const { return static_cast<Index>(transforms_.size()); }
  Index hidden_features() const { return transforms_.front().hidden_features(); }

  Index dimension_;
  Index context_features_;
  Block context_weight_;  ///< (F, K hidden): c W_c of all transforms in one product
  Block context_bias_;    ///< (1, K hidden)
  std::vector<AutoregressiveTransform<S>> transforms_;
  std::vector<std::vector<std::uint32_t>> order_;  ///< K x (D): variable j comes from order[j]
};

}  // namespace npdr::inference
