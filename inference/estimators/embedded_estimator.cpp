#include "inference/estimators/embedded_estimator.h"

#include "core/error.h"
#include "core/matrix_blocking.h"
#include "core/text.h"
#include "inference/estimators/maf.h"
#include "inference/estimators/mixture_density_network.h"
#include "inference/estimators/scalar.h"

namespace npdr::inference {

template <typename S>
std::unique_ptr<DensityEstimator<S>> make_estimator(const EstimatorConfig& config, Index dimension,
                                                    Index context_features,
                                                    const StreamId& structure,
                                                    ParameterLayout& layout) {
  switch (config.kind) {
    case EstimatorKind::maf:
    case EstimatorKind::nsf:
      return std::make_unique<MaskedAutoregressiveFlow<S>>(config, dimension, context_features,
                                                           structure, layout);
    case EstimatorKind::mdn:
      return std::make_unique<MixtureDensityNetwork<S>>(config, dimension, context_features,
                                                        layout);
    case EstimatorKind::resnet:
      break;
  }
  throw InputError("density_estimator.kind = '" + name_of(config.kind) + "', must be one of " +
                   join(to_names(kinds_that_give(Estimate::density))) +
                   ": it gives ratios, no density");
}

template <typename S>
EmbeddedEstimator<S>::EmbeddedEstimator(Index x_features, const TrainedEmbeddingConfig& embedding,
                                        const EstimatorConfig& config, Index dimension,
                                        const StreamId& structure)
    : x_features_(x_features) {
  fix_matrix_blocking();
  Index context_features = x_features;
  if (embedding.features > 0) {
    embedding_.emplace(embedding, x_features, layout_);
    context_features = embedding.features;
  }
  estimator_ = make_estimator<S>(config, dimension, context_features, structure, layout_);
}

template <typename S>
Parameters<S> EmbeddedEstimator<S>::initial_parameters(const StreamId& id) const {
  Parameters<S> parameters = Parameters<S>::Zero(num_parameters());
  Stream stream(id);
  if (embedding_) embedding_->initialize(parameters, stream);
  estimator_->initialize(parameters, stream);
  return parameters;
}

template <typename S>
typename EmbeddedEstimator<S>::Scratch EmbeddedEstimator<S>::make_scratch() const {
  Scratch scratch;
  scratch.estimator = estimator_->make_scratch();
  return scratch;
}

template <typename S>
const RowMatrixX<S>& EmbeddedEstimator<S>::embed(const Parameters<S>& parameters,
                                                 const RowMatrixX<S>& x, Scratch& scratch) const {
  if (!embedding_) return x;
  embedding_->forward(parameters, x, scratch.embedding, scratch.context);
  return scratch.context;
}

template <typename S>
RowMatrixX<S>* EmbeddedEstimator<S>::d_context(Scratch& scratch) const {
  return embedding_ ? &scratch.d_context : nullptr;
}

template <typename S>
void EmbeddedEstimator<S>::backward_embedding(const Parameters<S>& parameters,
                                              const RowMatrixX<S>& x, Scratch& scratch,
                                              Parameters<S>& gradient) const {
  if (!embedding_) return;
  embedding_->backward(parameters, x, scratch.d_context, scratch.embedding, gradient);
}

template <typename S>
void EmbeddedEstimator<S>::log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                                    const RowMatrixX<S>& x, Scratch& scratch,
                                    VectorX<S>& log_prob) const {
  estimator_->log_prob(parameters, u, embed(parameters, x, scratch), *scratch.estimator, log_prob);
}

template <typename S>
void EmbeddedEstimator<S>::backward(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                                    const RowMatrixX<S>& x, const VectorX<S>& d_log_prob,
                                    Scratch& scratch, Parameters<S>& gradient) const {
  const RowMatrixX<S>& context = embedding_ ? scratch.context : x;
  estimator_->backward(parameters, u, context, d_log_prob, *scratch.estimator, gradient,
                       d_context(scratch));
  backward_embedding(parameters, x, scratch, gradient);
}

template <typename S>
RowMatrixX<S> EmbeddedEstimator<S>::sample(const Parameters<S>& parameters, const RowMatrixX<S>& x,
                                           Index count, const StreamId& id) const {
  Scratch scratch;
  return estimator_->sample(parameters, embed(parameters, x, scratch), count, id);
}

template class EmbeddedEstimator<NPDR_SCALAR>;

}  // namespace npdr::inference
