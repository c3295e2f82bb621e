#include "inference/estimators/ratio_estimator.h"

#include <string>

#include "core/matrix_blocking.h"
#include "inference/estimators/dense.h"
#include "inference/estimators/scalar.h"
#include "inference/estimators/size_check.h"

namespace npdr::inference {

template <typename S>
RatioEstimator<S>::RatioEstimator(const EstimatorConfig& config, Index dimension, Index x_features)
    : dimension_(dimension), x_features_(x_features) {
  check_size("hidden_features", config.hidden_features);
  check_size("num_hidden_layers", config.num_hidden_layers);
  fix_matrix_blocking();
  const Size hidden{config.hidden_features, "h"}, one{1, "1"};
  u_weight_ = layout_.add("u.weight", {dimension, "v"}, hidden, "W_u");
  x_weight_ = layout_.add("x.weight", {x_features, "c"}, hidden, "W_x");
  bias_ = layout_.add_bias("x.bias", hidden, "b");
  for (Index l = 1; l <= config.num_hidden_layers; ++l) {
    layout_.begin_names_with("block_" + std::to_string(l) + ".");
    blocks_.push_back({.a_weight = layout_.add("a.weight", hidden, hidden, "A_l"),
                       .a_bias = layout_.add_bias("a.bias", hidden, "a_l"),
                       .b_weight = layout_.add("b.weight", hidden, hidden, "B_l"),
                       .b_bias = layout_.add_bias("b.bias", hidden, "b_l")});
  }
  layout_.begin_names_with("");
  out_weight_ = layout_.add("output.weight", hidden, one, "w");
  out_bias_ = layout_.add_bias("output.bias", one, "c");
}

template <typename S>
Parameters<S> RatioEstimator<S>::initial_parameters(const StreamId& id) const {
  Parameters<S> parameters = Parameters<S>::Zero(num_parameters());
  Stream stream(id);
  RowMatrixX<S> no_bias;
  initialize_dense(view(parameters, u_weight_), no_bias, stream);
  initialize_dense(view(parameters, x_weight_), view(parameters, bias_), stream);
  for (const ResidualBlock& block : blocks_) {
    initialize_dense(view(parameters, block.a_weight), view(parameters, block.a_bias), stream);
    initialize_dense(view(parameters, block.b_weight), view(parameters, block.b_bias), stream, 0.1);
  }
  initialize_dense(view(parameters, out_weight_), view(parameters, out_bias_), stream, 0.1);
  return parameters;
}

template <typename S>
void RatioEstimator<S>::logits(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                               const RowMatrixX<S>& x, RatioScratch<S>& scratch,
                               VectorX<S>& logits) const {
  scratch.hidden.resize(blocks_.size() + 1);
  scratch.inner.resize(blocks_.size());
  dense(x, view(parameters, x_weight_), view(parameters, bias_), scratch.context);
  repeat_groups(scratch.context, u.rows(), scratch.hidden[0]);
  scratch.hidden[0].noalias() += u * view(parameters, u_weight_);
  for (std::size_t l = 0; l < blocks_.size(); ++l) {
    const ResidualBlock& block = blocks_[l];
    scratch.active = scratch.hidden[l].cwiseMax(S(0));
    dense(scratch.active, view(parameters, block.a_weight), view(parameters, block.a_bias),
          scratch.inner[l]);
    scratch.inner[l] = scratch.inner[l].cwiseMax(S(0));
    dense(scratch.inner[l], view(parameters, block.b_weight), view(parameters, block.b_bias),
          scratch.hidden[l + 1]);
    scratch.hidden[l + 1] += scratch.hidden[l];
  }
  scratch.active = scratch.hidden.back().cwiseMax(S(0));
  logits.noalias() = scratch.active * view(parameters, out_weight_);
  logits.array() += view(parameters, out_bias_)(0, 0);
}

template <typename S>
void RatioEstimator<S>::backward(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                                 const RowMatrixX<S>& x, const VectorX<S>& d_logits,
                                 RatioScratch<S>& scratch, Parameters<S>& gradient) const {
  dense_gradient(scratch.active, d_logits, view(gradient, out_weight_), view(gradient, out_bias_));
  scratch.d_hidden.noalias() = d_logits * view(parameters, out_weight_).transpose();
  relu_backward(scratch.active, scratch.d_hidden);
  for (std::size_t l = blocks_.size(); l-- > 0;) {
    const ResidualBlock& block = blocks_[l];
    dense_gradient(scratch.inner[l], scratch.d_hidden, view(gradient, block.b_weight),
                   view(gradient, block.b_bias));
    scratch.d_inner.noalias() = scratch.d_hidden * view(parameters, block.b_weight).transpose();
    relu_backward(scratch.inner[l], scratch.d_inner);
    scratch.active = scratch.hidden[l].cwiseMax(S(0));
    dense_gradient(scratch.active, scratch.d_inner, view(gradient, block.a_weight),
                   view(gradient, block.a_bias));
    // The block's own input: past it, and through it.
    RowMatrixX<S>& through = scratch.inner[l];
    through.noalias() = scratch.d_inner * view(parameters, block.a_weight).transpose();
    relu_backward(scratch.active, through);
    scratch.d_hidden += through;
  }
  view(gradient, u_weight_).noalias() = u.transpose() * scratch.d_hidden;
  scratch.d_context.resize(x.rows(), scratch.context.cols());
  sum_groups(scratch.d_hidden, scratch.d_context);
  dense_gradient(x, scratch.d_context, view(gradient, x_weight_), view(gradient, bias_));
}

template class RatioEstimator<NPDR_SCALAR>;

}  // namespace npdr::inference
