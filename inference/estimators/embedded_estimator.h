/// The whole trained network: x -> (trained linear layer) -> conditional density of u.
///
///   c = x W + b  ("linear" embedding; c = x for the others),   q(u | x) = q_estimator(u | c).
/// x: (n, F), standardized. One flat parameter vector holds W, b and the estimator's weights.
#pragma once

#include <memory>

#include "inference/estimators/density_estimator.h"

namespace npdr::inference {

template <typename S>
class EmbeddedEstimator {
 public:
  struct Scratch {
    RowMatrixX<S> context;    ///< (n, features)
    RowMatrixX<S> d_context;  ///< (n, features)
    std::unique_ptr<EstimatorScratch> estimator;
  };

  /// trained_features: width of the linear layer; 0: none.
  EmbeddedEstimator(Index x_features, Index trained_features, const EstimatorConfig& config,
                    Index dimension, const StreamId& structure);

  Index dimension() const { return estimator_->dimension(); }
  Index x_features() const { return x_features_; }
  Index num_parameters() const { return layout_.size(); }
  const ParameterLayout& layout() const { return layout_; }
  const DensityEstimator<S>& estimator() const { return *estimator_; }

  /// Fresh random weights; see DensityEstimator::initialize.
  Parameters<S> initial_parameters(const StreamId& id) const;
  Scratch make_scratch() const;

  /// The context of x: scratch.context, or x itself when no layer is trained.
  const RowMatrixX<S>& embed(const Parameters<S>& parameters, const RowMatrixX<S>& x,
                             Scratch& scratch) const;
  /// The place for the estimator to leave dL/dcontext in; null when nothing needs it.
  RowMatrixX<S>* d_context(Scratch& scratch) const;
  /// Gradient of the linear layer from scratch.d_context.
  void backward_embedding(const RowMatrixX<S>& x, Scratch& scratch, Parameters<S>& gradient) const;

  /// Does what DensityEstimator's does, with x in place of the context.
  void log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u, const RowMatrixX<S>& x,
                Scratch& scratch, VectorX<S>& log_prob) const;
  void backward(const Parameters<S>& parameters, const RowMatrixX<S>& u, const RowMatrixX<S>& x,
                const VectorX<S>& d_log_prob, Scratch& scratch, Parameters<S>& gradient) const;

  /// `count` samples of q(. | x) for one x (1, F); sample i uses row id.row + i of the stream.
  RowMatrixX<S> sample(const Parameters<S>& parameters, const RowMatrixX<S>& x, Index count,
                       const StreamId& id) const;

 private:
  bool has_layer() const { return weight_.rows > 0; }

  Index x_features_;
  ParameterLayout layout_;
  Block weight_;  ///< (F, features)
  Block bias_;    ///< (1, features)
  std::unique_ptr<DensityEstimator<S>> estimator_;
};

}  // namespace npdr::inference
