/// The whole trained network: x -> (trained embedding) -> conditional density of u.
///
///   q(u | x) = q_estimator(u | c),   c = embedding(x), or x itself where no layer is trained.
/// x: (n, F), standardized. One flat parameter vector holds all weights.
#pragma once

#include <memory>
#include <optional>

#include "inference/estimators/density_estimator.h"
#include "inference/estimators/trained_embedding.h"

namespace npdr::inference {

template <typename S>
class EmbeddedEstimator {
 public:
  struct Scratch {
    RowMatrixX<S> context;    ///< (n, features)
    RowMatrixX<S> d_context;  ///< (n, features)
    std::unique_ptr<EstimatorScratch> estimator;
    typename TrainedEmbedding<S>::Scratch embedding;
  };

  EmbeddedEstimator(Index x_features, const TrainedEmbeddingConfig& embedding,
                    const EstimatorConfig& config, Index dimension, const StreamId& structure);

  Index dimension() const { return estimator_->dimension(); }
  Index x_features() const { return x_features_; }
  Index num_parameters() const { return layout_.size(); }
  const ParameterLayout& layout() const { return layout_; }
  const DensityEstimator<S>& estimator() const { return *estimator_; }

  /// Fresh random weights; see DensityEstimator::initialize.
  Parameters<S> initial_parameters(const StreamId& id) const;
  Scratch make_scratch() const;

  /// The context of x: scratch.context, or x itself where no layer is trained.
  const RowMatrixX<S>& embed(const Parameters<S>& parameters, const RowMatrixX<S>& x,
                             Scratch& scratch) const;
  /// The place for the estimator to leave dL/dcontext in; null when nothing needs it.
  RowMatrixX<S>* d_context(Scratch& scratch) const;
  /// Gradient of the embedding's weights from scratch.d_context.
  void backward_embedding(const Parameters<S>& parameters, const RowMatrixX<S>& x, Scratch& scratch,
                          Parameters<S>& gradient) const;

  /// Does what DensityEstimator's does, with x in place of the context.
  void log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u, const RowMatrixX<S>& x,
                Scratch& scratch, VectorX<S>& log_prob) const;
  void backward(const Parameters<S>& parameters, const RowMatrixX<S>& u, const RowMatrixX<S>& x,
                const VectorX<S>& d_log_prob, Scratch& scratch, Parameters<S>& gradient) const;

  /// `count` samples of q(. | x) for one x (1, F); sample i uses row id.row + i of the stream.
  RowMatrixX<S> sample(const Parameters<S>& parameters, const RowMatrixX<S>& x, Index count,
                       const StreamId& id) const;

 private:
  Index x_features_;
  ParameterLayout layout_;
  std::optional<TrainedEmbedding<S>> embedding_;
  std::unique_ptr<DensityEstimator<S>> estimator_;
};

}  // namespace npdr::inference
