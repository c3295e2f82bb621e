/// Residual network that tells a pair (u, x) of a simulation from one that was put together: its
/// logit f(u, x) learns a log likelihood-to-evidence ratio (ratio_loss.h).
///
/// Source: He et al. 2016, "Identity mappings in deep residual networks", with fully connected
/// layers. With r = max(0, .),
///   h_0 = u W_u + x W_x + b,   h_l = h_{l-1} + r(r(h_{l-1}) A_l + a_l) B_l + b_l,   l = 1, ..., L,
///   f = r(h_L) w + c.
/// k values of u share a row of x, as everywhere (density_estimator.h): x W_x is computed once for
/// all of them.
#pragma once

#include <vector>

#include "core/random.h"
#include "inference/estimators/estimator_config.h"
#include "inference/estimators/parameters.h"

namespace npdr::inference {

/// Memory of a forward pass for the backward pass; one per thread. m = n k rows of u.
template <typename S>
struct RatioScratch {
  RowMatrixX<S> context;              ///< (n, hidden): x W_x + b
  std::vector<RowMatrixX<S>> hidden;  ///< L + 1 x (m, hidden): h_0, ..., h_L
  std::vector<RowMatrixX<S>> inner;   ///< L x (m, hidden): r(r(h) A + a)
  RowMatrixX<S> active;               ///< (m, hidden): r(h)
  RowMatrixX<S> d_hidden, d_inner, d_context;
};

/// The architecture, without its weights, which callers own. Const calls are thread-safe.
template <typename S>
class RatioEstimator {
 public:
  /// Throws InputError for sizes below 1.
  RatioEstimator(const EstimatorConfig& config, Index dimension, Index x_features);

  Index dimension() const { return dimension_; }
  Index x_features() const { return x_features_; }
  Index num_parameters() const { return layout_.size(); }
  const ParameterLayout& layout() const { return layout_; }

  /// Fresh random weights, with which f is near 0.
  Parameters<S> initial_parameters(const StreamId& id) const;

  /// f into `logits` (m), for u (m, D) and x (n, F) with m = n k.
  void logits(const Parameters<S>& parameters, const RowMatrixX<S>& u, const RowMatrixX<S>& x,
              RatioScratch<S>& scratch, VectorX<S>& logits) const;

  /// Given dL/dlogits (m) of the last logits() call, overwrites `gradient` with dL/dparameters.
  void backward(const Parameters<S>& parameters, const RowMatrixX<S>& u, const RowMatrixX<S>& x,
                const VectorX<S>& d_logits, RatioScratch<S>& scratch,
                Parameters<S>& gradient) const;

 private:
  struct ResidualBlock {
    Block a_weight, a_bias, b_weight, b_bias;
  };

  Index dimension_;
  Index x_features_;
  ParameterLayout layout_;
  Block u_weight_;  ///< (D, hidden)
  Block x_weight_;  ///< (F, hidden)
  Block bias_;      ///< (1, hidden)
  std::vector<ResidualBlock> blocks_;
  Block out_weight_;  ///< (hidden, 1)
  Block out_bias_;    ///< (1, 1)
};

}  // namespace npdr::inference
