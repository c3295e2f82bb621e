#include "inference/estimators/mixture_density_network.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/log_sum_exp.h"
#include "inference/estimators/dense.h"
#include "inference/estimators/scalar.h"
#include "inference/estimators/size_check.h"
#include "inference/estimators/softplus.h"

namespace npdr::inference {
namespace {

// values[i] = u[i] - mean[i]; mean stays where it is with kStride = 0, where all points share it.
template <int kStride, typename S>
void subtract(const S* __restrict u, const S* __restrict mean, Index count, S* __restrict values) {
#pragma omp simd
  for (Index i = 0; i < count; ++i) values[i] = u[i] - mean[i * kStride];
}

// sum[i] += factor[i] values[i].
template <int kStride, typename S>
void add_product(const S* __restrict factor, const S* __restrict values, Index count,
                 S* __restrict sum) {
#pragma omp simd
  for (Index i = 0; i < count; ++i) sum[i] += factor[i * kStride] * values[i];
}

// d_factor -= d y and d_mean += d U: the derivatives of -|y|^2 / 2 given d = y dL/dlog_prob, where
// y = U (u - mu).
template <typename S>
void add_gradient_of_entry(const S* __restrict d, const S* __restrict deviation,
                           const S* __restrict factor, Index count, S* __restrict d_factor,
                           S* __restrict d_mean) {
#pragma omp simd
  for (Index i = 0; i < count; ++i) {
    d_factor[i] -= d[i] * deviation[i];
    d_mean[i] += d[i] * factor[i];
  }
}

}  // namespace

template <typename S>
MixtureDensityNetwork<S>::MixtureDensityNetwork(const EstimatorConfig& config, Index dimension,
                                                Index context_features, ParameterLayout& layout)
    : dimension_(dimension),
      context_features_(context_features),
      components_(config.num_components) {
  check_size("num_components", config.num_components);
  check_size("hidden_features", config.hidden_features);
  check_size("num_hidden_layers", config.num_hidden_layers);
  Size inputs{context_features, "c"};
  const auto add = [&](const std::string& name, const Size& outputs, const char* meaning) {
    weights_.push_back(layout.add(name + ".weight", inputs, outputs, meaning));
    biases_.push_back(layout.add_bias(name + ".bias", outputs, "its bias"));
    inputs = outputs;
  };
  for (Index l = 1; l <= config.num_hidden_layers; ++l) {
    add("hidden_" + std::to_string(l), {config.hidden_features, "h"}, "of a hidden layer");
  }
  add("head", {num_columns(), "q K"},
      "K logits of the weights, K means of each variable, then K of each entry of U, row by row");
}

template <typename S>
Index MixtureDensityNetwork<S>::num_columns() const {
  return (1 + dimension_ + dimension_ * (dimension_ + 1) / 2) * components_;
}

template <typename S>
Index MixtureDensityNetwork<S>::factor_column(Index i, Index j) const {
  const Index before_row = i * dimension_ - i * (i - 1) / 2;
  return (1 + dimension_ + before_row + (j - i)) * components_;
}

template <typename S>
void MixtureDensityNetwork<S>::initialize(Parameters<S>& parameters, Stream& stream) const {
  for (std::size_t l = 0; l < weights_.size(); ++l) {
    const bool is_head = l + 1 == weights_.size();
    initialize_dense(view(parameters, weights_[l]), view(parameters, biases_[l]), stream,
                     is_head ? 0.1 : 1.0);
  }
  // Components start at different places, or they would all learn the same.
  auto bias = view(parameters, biases_.back());
  for (Index c = mean_column(0); c < factor_column(0, 0); ++c) {
    if (components_ > 1) bias(0, c) = static_cast<S>(0.5 * stream.normal());
  }
}

template <typename S>
void MixtureDensityNetwork<S>::grow(const MixtureDensityNetwork& single,
                                    const Parameters<S>& single_parameters, double perturbation,
                                    Parameters<S>& parameters, Stream& stream) const {
  // An embedding's layer and the trunk have the same place in both.
  const Index before_head = weights_.back().offset;
  parameters.head(before_head) = single_parameters.head(before_head);
  const auto from_weight = view(single_parameters, single.weights_.back());
  const auto from_bias = view(single_parameters, single.biases_.back());
  auto weight = view(parameters, weights_.back());
  auto bias = view(parameters, biases_.back());
  for (Index column = 0; column < weight.cols(); ++column) {
    const Index quantity = column / components_;
    const bool is_weight = quantity == 0;  // all components begin with the same
    const auto disturbed = [&](S value) {
      return is_weight ? S(0) : value + static_cast<S>(perturbation * stream.normal());
    };
    for (Index i = 0; i < weight.rows(); ++i) {
      weight(i, column) = disturbed(from_weight(i, quantity));
    }
    bias(0, column) = disturbed(from_bias(0, quantity));
  }
}

template <typename S>
std::unique_ptr<EstimatorScratch> MixtureDensityNetwork<S>::make_scratch() const {
  auto scratch = std::make_unique<MixtureScratch<S>>();
  scratch->hidden.resize(weights_.size() - 1);
  return scratch;
}

template <typename S>
void MixtureDensityNetwork<S>::forward_heads(const Parameters<S>& parameters,
                                             const RowMatrixX<S>& context,
                                             MixtureScratch<S>& scratch) const {
  const RowMatrixX<S>* input = &context;
  for (std::size_t l = 0; l < scratch.hidden.size(); ++l) {
    dense_tanh(*input, view(parameters, weights_[l]), view(parameters, biases_[l]),
               scratch.hidden[l]);
    input = &scratch.hidden[l];
  }
  dense(*input, view(parameters, weights_.back()), view(parameters, biases_.back()), scratch.heads);
  auto logits = scratch.heads.middleCols(weight_column(), components_);
  logits.array().colwise() -= log_sum_exp_of_rows(logits);
  for (Index i = 0; i < dimension_; ++i) {
    auto a = scratch.heads.middleCols(factor_column(i, i), components_).array();
    a += S(kScaleOffset);
    a = (softplus(a) + S(kSmallestScale)).eval();
  }
}

// Whitens the points first, ..., first + count - 1 and adds -|y|^2 / 2 of `component`. Point first
// + i has the head of context i, or all have that of the only context (kStride = 0).
template <typename S>
template <int kStride>
void MixtureDensityNetwork<S>::add_log_densities(Index component, Index first, Index count,
                                                 MixtureScratch<S>& scratch) const {
  const auto head = [&](Index column) { return scratch.heads.col(column + component).data(); };
  S* log_density = scratch.responsibility.col(component).data() + first;
  for (Index j = 0; j < dimension_; ++j) {
    subtract<kStride>(scratch.points.col(j).data() + first, head(mean_column(j)), count,
                      scratch.deviation.col(j).data());
  }
  for (Index i = 0; i < dimension_; ++i) {
    S* y = scratch.whitened.col(component * dimension_ + i).data() + first;
    std::fill(y, y + count, S(0));
    for (Index j = i; j < dimension_; ++j) {
      add_product<kStride>(head(factor_column(i, j)), scratch.deviation.col(j).data(), count, y);
    }
#pragma omp simd
    for (Index r = 0; r < count; ++r) log_density[r] -= S(0.5) * y[r] * y[r];
  }
}

template <typename S>
void MixtureDensityNetwork<S>::log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                                        const RowMatrixX<S>& context, EstimatorScratch& base,
                                        VectorX<S>& log_prob) const {
  auto& scratch = static_cast<MixtureScratch<S>&>(base);
  forward_heads(parameters, context, scratch);
  const Index m = u.rows(), n = context.rows(), k = m / n;
  scratch.points.resize(m, dimension_);
  for (Index a = 0; a < k; ++a) {
    for (Index g = 0; g < n; ++g) scratch.points.row(a * n + g) = u.row(g * k + a);
  }
  // Loops run over contexts; over points where one context is that of all.
  const Index count = n == 1 ? m : n;
  scratch.deviation.resize(count, dimension_);
  scratch.whitened.resize(m, dimension_ * components_);
  scratch.responsibility.resize(m, components_);
  for (Index c = 0; c < components_; ++c) {
    Eigen::Array<S, Eigen::Dynamic, 1> log_scale = scratch.heads.col(weight_column() + c);
    log_scale -= S(0.5 * kLogTwoPi * static_cast<double>(dimension_));
    for (Index i = 0; i < dimension_; ++i) {
      log_scale += scratch.heads.col(factor_column(i, i) + c).array().log();
    }
    scratch.responsibility.col(c) = log_scale.replicate(k, 1);
    if (n == 1) {
      add_log_densities<0>(c, 0, m, scratch);
    } else {
      for (Index a = 0; a < k; ++a) add_log_densities<1>(c, a * n, n, scratch);
    }
  }
  const auto total = log_sum_exp_of_rows(scratch.responsibility);
  scratch.responsibility = (scratch.responsibility.array().colwise() - total).exp();
  log_prob.resize(m);
  Eigen::Map<RowMatrixX<S>>(log_prob.data(), n, k) =
      Eigen::Map<const ColumnMatrixX<S>>(total.data(), n, k);
}

template <typename S>
void MixtureDensityNetwork<S>::backward(const Parameters<S>& parameters, const RowMatrixX<S>&,
                                        const RowMatrixX<S>& context, const VectorX<S>& d_log_prob,
                                        EstimatorScratch& base, Parameters<S>& gradient,
                                        RowMatrixX<S>* d_context) const {
  auto& scratch = static_cast<MixtureScratch<S>&>(base);
  accumulate_heads(d_log_prob, scratch);
  backward_heads(parameters, context, scratch, gradient, d_context);
}

// Adds what the points first, ..., first + n - 1 give to d_heads of `component`: weight (n) is
// dL/dlog_prob times its responsibility.
template <typename S>
void MixtureDensityNetwork<S>::add_gradient(Index component, Index first, const VectorX<S>& weight,
                                            MixtureScratch<S>& scratch) const {
  const Index n = weight.size();
  const auto head = [&](Index column) { return scratch.heads.col(column + component).data(); };
  const auto d_head = [&](Index column) { return scratch.d_heads.col(column + component).data(); };
  for (Index j = 0; j < dimension_; ++j) {
    subtract<1>(scratch.points.col(j).data() + first, head(mean_column(j)), n,
                scratch.deviation.col(j).data());
  }
  VectorX<S> d(n);
  for (Index i = 0; i < dimension_; ++i) {
    d = scratch.whitened.col(component * dimension_ + i).segment(first, n).cwiseProduct(weight);
    for (Index j = i; j < dimension_; ++j) {
      add_gradient_of_entry(d.data(), scratch.deviation.col(j).data(), head(factor_column(i, j)), n,
                            d_head(factor_column(i, j)), d_head(mean_column(j)));
    }
  }
}

template <typename S>
void MixtureDensityNetwork<S>::accumulate_heads(const VectorX<S>& d_log_prob,
                                                MixtureScratch<S>& scratch) const {
  const Index n = scratch.heads.rows(), k = d_log_prob.size() / n;
  const ColumnMatrixX<S> d = Eigen::Map<const RowMatrixX<S>>(d_log_prob.data(), n, k);
  scratch.d_heads.setZero(n, num_columns());
  VectorX<S> weight(n);
  for (Index c = 0; c < components_; ++c) {
    auto d_log_weight = scratch.d_heads.col(weight_column() + c);
    for (Index a = 0; a < k; ++a) {
      weight = d.col(a).cwiseProduct(scratch.responsibility.col(c).segment(a * n, n));
      d_log_weight += weight;
      add_gradient(c, a * n, weight, scratch);
    }
    for (Index i = 0; i < dimension_; ++i) {
      const Index column = factor_column(i, i) + c;
      scratch.d_heads.col(column) += d_log_weight.cwiseQuotient(scratch.heads.col(column));
    }
  }
}

template <typename S>
void MixtureDensityNetwork<S>::backward_heads(const Parameters<S>& parameters,
                                              const RowMatrixX<S>& context,
                                              MixtureScratch<S>& scratch, Parameters<S>& gradient,
                                              RowMatrixX<S>* d_context) const {
  ColumnMatrixX<S>& d = scratch.d_heads;
  // Through the log softmax: d logit = d log_weight - softmax * sum of d log_weight.
  auto d_weight = d.middleCols(weight_column(), components_).array();
  const auto log_weight = scratch.heads.middleCols(weight_column(), components_).array();
  const Eigen::Array<S, Eigen::Dynamic, 1> total = d_weight.rowwise().sum();
  d_weight -= log_weight.exp().colwise() * total;
  // Through the softplus of the diagonal.
  for (Index i = 0; i < dimension_; ++i) {
    const Index column = factor_column(i, i);
    d.middleCols(column, components_).array() *=
        S(1) - (S(kSmallestScale) - scratch.heads.middleCols(column, components_).array()).exp();
  }
  const std::size_t layers = scratch.hidden.size();
  const auto below = [&](std::size_t l, const auto& d_above) {
    dense_gradient(scratch.hidden[l - 1], d_above, view(gradient, weights_[l]),
                   view(gradient, biases_[l]));
    scratch.d_below.noalias() = d_above * view(parameters, weights_[l]).transpose();
    tanh_backward(scratch.hidden[l - 1], scratch.d_below);
    scratch.d_hidden.swap(scratch.d_below);
  };
  below(layers, d);
  for (std::size_t l = layers - 1; l > 0; --l) below(l, scratch.d_hidden);
  dense_gradient(context, scratch.d_hidden, view(gradient, weights_[0]),
                 view(gradient, biases_[0]));
  if (d_context == nullptr) return;
  d_context->noalias() = scratch.d_hidden * view(parameters, weights_[0]).transpose();
}

template <typename S>
GaussianMixture MixtureDensityNetwork<S>::mixture(const MixtureScratch<S>& scratch, Index n) const {
  const auto head = scratch.heads.row(n);
  GaussianMixture result;
  result.log_weights =
      head.segment(weight_column(), components_).transpose().template cast<double>();
  for (Index k = 0; k < components_; ++k) {
    Vector mean(dimension_);
    Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(dimension_, dimension_);
    for (Index i = 0; i < dimension_; ++i) {
      mean(i) = static_cast<double>(head(mean_column(i) + k));
      for (Index j = i; j < dimension_; ++j) {
        factor(i, j) = static_cast<double>(head(factor_column(i, j) + k));
      }
    }
    result.means.push_back(std::move(mean));
    result.precision_factors.push_back(std::move(factor));
  }
  // In single precision the weights sum to 1 to seven digits only.
  result.log_weights.array() -= log_sum_exp(result.log_weights);
  return result;
}

template <typename S>
RowMatrixX<S> MixtureDensityNetwork<S>::sample(const Parameters<S>& parameters,
                                               const RowMatrixX<S>& context, Index count,
                                               const StreamId& id) const {
  MixtureScratch<S> scratch;
  scratch.hidden.resize(weights_.size() - 1);
  forward_heads(parameters, context, scratch);
  return mixture(scratch, 0).sample(count, id).template cast<S>();
}

template class MixtureDensityNetwork<NPDR_SCALAR>;

}  // namespace npdr::inference
