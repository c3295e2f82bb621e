#include "inference/estimators/trained_embedding.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "inference/estimators/dense.h"
#include "inference/estimators/scalar.h"

namespace npdr::inference {
namespace {

constexpr Index kLargestKernel = 8;  // steps that an output of a convolution sees
constexpr Index kStride = 4;
constexpr Index kWidth = 32;

SeriesShape series_of(const TrainedEmbeddingConfig& config, Index num_inputs) {
  if (!config.has_convolutions()) return {1, 1, num_inputs};
  const SeriesShape& series = config.series;
  if (series.num_values() == num_inputs) return series;
  throw ShapeError("embedding: a series of " + std::to_string(series.num_values()) +
                   " values for " + std::to_string(num_inputs) + " features");
}

}  // namespace

template <typename S>
Index TrainedEmbedding<S>::Convolution::offset() const {
  return (steps_in - kernel) % kStride * channels_in;
}

template <typename S>
TrainedEmbedding<S>::TrainedEmbedding(const TrainedEmbeddingConfig& config, Index num_inputs,
                                      ParameterLayout& layout)
    : series_(series_of(config, num_inputs)), average_rollouts_(config.average_rollouts) {
  Index steps = series_.num_steps, channels = series_.num_channels;
  while (steps >= kLargestKernel || (average_rollouts_ && convolutions_.empty())) {
    const Index kernel = std::min(kLargestKernel, steps);
    const std::string name = "convolution_" + std::to_string(convolutions_.size() + 1);
    Convolution layer{kernel, steps, channels, (steps - kernel) / kStride + 1};
    layer.weight = layout.add(name + ".weight", {kernel * channels, "patch"}, {kWidth, "y"},
                              "of a trained convolution, where there is one");
    layer.bias = layout.add_bias(name + ".bias", {kWidth, "y"}, "its bias");
    convolutions_.push_back(layer);
    steps = layer.steps_out;
    channels = kWidth;
  }
  const Index rollouts = average_rollouts_ ? 1 : series_.num_rollouts;
  const Size width{config.features, "c"};
  weight_ = layout.add("linear.weight",
                       {rollouts * steps * channels, convolutions_.empty() ? "z" : "y_last"}, width,
                       "of the trained linear layer, where there is one");
  bias_ = layout.add_bias("linear.bias", width, "its bias");
}

template <typename S>
void TrainedEmbedding<S>::initialize(Parameters<S>& parameters, Stream& stream) const {
  const double he = std::sqrt(6.0);  // keeps the variance behind max(0, .)
  for (const Convolution& layer : convolutions_) {
    initialize_dense(view(parameters, layer.weight), view(parameters, layer.bias), stream, he);
    view(parameters, layer.bias).setZero();
  }
  initialize_dense(view(parameters, weight_), view(parameters, bias_), stream);
}

// Row t is what output t sees of one rollout. Nothing is copied: the rows overlap.
template <typename S>
typename TrainedEmbedding<S>::Patches TrainedEmbedding<S>::patches(const Convolution& layer,
                                                                   const S* series) const {
  return {series + layer.offset(), layer.steps_out, layer.kernel * layer.channels_in,
          Eigen::OuterStride<>(kStride * layer.channels_in)};
}

template <typename S>
void TrainedEmbedding<S>::convolve(const Parameters<S>& parameters, const Convolution& layer,
                                   const S* input, Index count, RowMatrixX<S>& y) const {
  const auto weight = view(parameters, layer.weight);
  y.resize(count * layer.steps_out, kWidth);
  for (Index i = 0; i < count; ++i) {
    y.middleRows(i * layer.steps_out, layer.steps_out).noalias() =
        patches(layer, input + i * layer.values_in()) * weight;
  }
  y = (y.rowwise() + view(parameters, layer.bias).row(0)).cwiseMax(S(0));
}

// Inputs of the linear layer, (n, inputs).
template <typename S>
typename TrainedEmbedding<S>::Flat TrainedEmbedding<S>::last_inputs(const RowMatrixX<S>& z,
                                                                    const Scratch& scratch) const {
  if (average_rollouts_) return {scratch.mean.data(), z.rows(), weight_.rows};
  return {convolutions_.empty() ? z.data() : scratch.y.back().data(), z.rows(), weight_.rows};
}

template <typename S>
void TrainedEmbedding<S>::forward(const Parameters<S>& parameters, const RowMatrixX<S>& z,
                                  Scratch& scratch, RowMatrixX<S>& context) const {
  const Index count = z.rows() * series_.num_rollouts;
  scratch.y.resize(convolutions_.size());
  const S* input = z.data();
  for (std::size_t l = 0; l < convolutions_.size(); ++l) {
    convolve(parameters, convolutions_[l], input, count, scratch.y[l]);
    input = scratch.y[l].data();
  }
  if (average_rollouts_) {
    scratch.mean.resize(z.rows(), weight_.rows);
    sum_groups(Flat(input, count, weight_.rows), scratch.mean);
    scratch.mean /= static_cast<S>(series_.num_rollouts);
  }
  dense(last_inputs(z, scratch), view(parameters, weight_), view(parameters, bias_), context);
}

template <typename S>
void TrainedEmbedding<S>::convolution_gradient(const Convolution& layer, const S* input,
                                               const RowMatrixX<S>& d_y,
                                               Parameters<S>& gradient) const {
  auto d_weight = view(gradient, layer.weight);
  d_weight.setZero();
  for (Index i = 0; i < d_y.rows() / layer.steps_out; ++i) {
    d_weight.noalias() += patches(layer, input + i * layer.values_in()).transpose() *
                          d_y.middleRows(i * layer.steps_out, layer.steps_out);
  }
  view(gradient, layer.bias).row(0) = d_y.colwise().sum();
}

template <typename S>
void TrainedEmbedding<S>::input_gradient(const Parameters<S>& parameters, const Convolution& layer,
                                         const RowMatrixX<S>& d_y, RowMatrixX<S>& d_input) const {
  using Row = Eigen::Map<Eigen::Matrix<S, 1, Eigen::Dynamic>>;
  const auto weight = view(parameters, layer.weight);
  const Index count = d_y.rows() / layer.steps_out, step = kStride * layer.channels_in;
  d_input.setZero(count * layer.steps_in, layer.channels_in);
  RowMatrixX<S> d_patches;
  for (Index i = 0; i < count; ++i) {
    d_patches.noalias() = d_y.middleRows(i * layer.steps_out, layer.steps_out) * weight.transpose();
    S* series = d_input.data() + i * layer.values_in() + layer.offset();
    for (Index t = 0; t < layer.steps_out; ++t) {
      Row(series + t * step, d_patches.cols()) += d_patches.row(t);
    }
  }
}

// dL/dy of the last convolution.
template <typename S>
void TrainedEmbedding<S>::last_input_gradient(const Parameters<S>& parameters,
                                              const RowMatrixX<S>& d_context,
                                              Scratch& scratch) const {
  const auto weight = view(parameters, weight_);
  const RowMatrixX<S>& y = scratch.y.back();
  RowMatrixX<S>& d_y = scratch.d_y.back();
  if (!average_rollouts_) {
    d_y.resize(y.rows(), y.cols());
    Eigen::Map<RowMatrixX<S>>(d_y.data(), d_context.rows(), weight.rows()).noalias() =
        d_context * weight.transpose();
    return;
  }
  d_y.resize(y.rows(), y.cols());
  scratch.d_mean.noalias() = d_context * weight.transpose();
  scratch.d_mean /= static_cast<S>(series_.num_rollouts);
  Eigen::Map<RowMatrixX<S>> rollouts(d_y.data(), d_context.rows() * series_.num_rollouts,
                                     weight.rows());
  repeat_groups(scratch.d_mean, rollouts.rows(), rollouts);
}

template <typename S>
void TrainedEmbedding<S>::backward(const Parameters<S>& parameters, const RowMatrixX<S>& z,
                                   const RowMatrixX<S>& d_context, Scratch& scratch,
                                   Parameters<S>& gradient) const {
  dense_gradient(last_inputs(z, scratch), d_context, view(gradient, weight_),
                 view(gradient, bias_));
  if (convolutions_.empty()) return;
  scratch.d_y.resize(convolutions_.size());
  last_input_gradient(parameters, d_context, scratch);
  for (std::size_t l = convolutions_.size(); l-- > 0;) {
    relu_backward(scratch.y[l], scratch.d_y[l]);
    const S* input = l > 0 ? scratch.y[l - 1].data() : z.data();
    convolution_gradient(convolutions_[l], input, scratch.d_y[l], gradient);
    if (l > 0) input_gradient(parameters, convolutions_[l], scratch.d_y[l], scratch.d_y[l - 1]);
  }
}

template class TrainedEmbedding<NPDR_SCALAR>;

}  // namespace npdr::inference
