#include "inference/estimators/mixture_density_network.h"

#include <cmath>
#include <numbers>
#include <string>

#include "inference/estimators/dense.h"
#include "inference/estimators/size_check.h"
#include "inference/estimators/softplus.h"

namespace npdr::inference {
namespace {

constexpr double kSmallestDiagonal = 1e-3;
const double kDiagonalOffset = std::log(std::expm1(1.0 - kSmallestDiagonal));

// Turns K raw logits into normalized log weights.
template <typename S>
void normalize_log_weights(S* logits, Index count) {
  Eigen::Map<Eigen::Array<S, Eigen::Dynamic, 1>> l(logits, count);
  const S largest = l.maxCoeff();
  l -= largest + std::log((l - largest).exp().sum());
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
  for (Index n = 0; n < context.rows(); ++n) {
    normalize_log_weights(&scratch.heads(n, weight_column()), components_);
  }
  for (Index i = 0; i < dimension_; ++i) {
    auto a = scratch.heads.middleCols(factor_column(i, i), components_).array();
    a += S(kDiagonalOffset);
    a = (softplus(a) + S(kSmallestDiagonal)).eval();
  }
}

template <typename S>
void MixtureDensityNetwork<S>::log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                                        const RowMatrixX<S>& context, EstimatorScratch& base,
                                        VectorX<S>& log_prob) const {
  auto& scratch = static_cast<MixtureScratch<S>&>(base);
  forward_heads(parameters, context, scratch);
  using Array = Eigen::Array<S, 1, Eigen::Dynamic>;
  const Index m = u.rows();
  const Index k = m / context.rows();
  scratch.whitened.resize(m, dimension_ * components_);
  scratch.responsibility.resize(m, components_);
  log_prob.resize(m);
  const S constant = S(-0.5 * std::log(2.0 * std::numbers::pi) * static_cast<double>(dimension_));
  Array terms(components_), y(components_);
  for (Index r = 0; r < m; ++r) {
    const auto head = scratch.heads.row(r / k).array();
    const auto part = [&](Index column) { return head.segment(column, components_); };
    terms = part(weight_column()) + constant;
    for (Index i = 0; i < dimension_; ++i) {
      y = part(factor_column(i, i)) * (u(r, i) - part(mean_column(i)));
      for (Index j = i + 1; j < dimension_; ++j) {
        y += part(factor_column(i, j)) * (u(r, j) - part(mean_column(j)));
      }
      scratch.whitened.row(r).segment(i * components_, components_) = y;
      terms += part(factor_column(i, i)).log() - S(0.5) * y.square();
    }
    const S largest = terms.maxCoeff();
    log_prob(r) = largest + std::log((terms - largest).exp().sum());
    scratch.responsibility.row(r) = (terms - log_prob(r)).exp();
  }
}

template <typename S>
void MixtureDensityNetwork<S>::backward(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                                        const RowMatrixX<S>& context, const VectorX<S>& d_log_prob,
                                        EstimatorScratch& base, Parameters<S>& gradient,
                                        RowMatrixX<S>* d_context) const {
  auto& scratch = static_cast<MixtureScratch<S>&>(base);
  accumulate_heads(u, d_log_prob, scratch);
  backward_heads(parameters, context, scratch, gradient, d_context);
}

template <typename S>
void MixtureDensityNetwork<S>::accumulate_heads(const RowMatrixX<S>& u,
                                                const VectorX<S>& d_log_prob,
                                                MixtureScratch<S>& scratch) const {
  using Array = Eigen::Array<S, 1, Eigen::Dynamic>;
  const Index n = scratch.heads.rows();
  scratch.d_heads.setZero(n, num_columns());
  const Index k = u.rows() / n;
  Array w(components_), y(components_);
  for (Index r = 0; r < u.rows(); ++r) {
    const auto head = scratch.heads.row(r / k).array();
    auto d_head = scratch.d_heads.row(r / k).array();
    const auto part = [&](Index column) { return head.segment(column, components_); };
    const auto d_part = [&](Index column) { return d_head.segment(column, components_); };
    w = d_log_prob(r) * scratch.responsibility.row(r).array();
    d_part(weight_column()) += w;
    for (Index i = 0; i < dimension_; ++i) {
      y = scratch.whitened.row(r).segment(i * components_, components_).array() * w;
      d_part(factor_column(i, i)) += w / part(factor_column(i, i));
      for (Index j = i; j < dimension_; ++j) {
        d_part(factor_column(i, j)) -= y * (u(r, j) - part(mean_column(j)));
        d_part(mean_column(j)) += y * part(factor_column(i, j));
      }
    }
  }
}

template <typename S>
void MixtureDensityNetwork<S>::backward_heads(const Parameters<S>& parameters,
                                              const RowMatrixX<S>& context,
                                              MixtureScratch<S>& scratch, Parameters<S>& gradient,
                                              RowMatrixX<S>* d_context) const {
  RowMatrixX<S>& d = scratch.d_heads;
  // Through the log softmax: d logit = d log_weight - softmax * sum of d log_weight.
  auto d_weight = d.middleCols(weight_column(), components_).array();
  const auto log_weight = scratch.heads.middleCols(weight_column(), components_).array();
  const Eigen::Array<S, Eigen::Dynamic, 1> total = d_weight.rowwise().sum();
  d_weight -= log_weight.exp().colwise() * total;
  // Through the softplus of the diagonal.
  for (Index i = 0; i < dimension_; ++i) {
    const Index column = factor_column(i, i);
    d.middleCols(column, components_).array() *=
        S(1) - (S(kSmallestDiagonal) - scratch.heads.middleCols(column, components_).array()).exp();
  }
  const std::size_t layers = scratch.hidden.size();
  const RowMatrixX<S>* d_above = &d;
  for (std::size_t l = layers; l > 0; --l) {
    dense_gradient(scratch.hidden[l - 1], *d_above, view(gradient, weights_[l]),
                   view(gradient, biases_[l]));
    scratch.d_below.noalias() = *d_above * view(parameters, weights_[l]).transpose();
    tanh_backward(scratch.hidden[l - 1], scratch.d_below);
    scratch.d_hidden.swap(scratch.d_below);
    d_above = &scratch.d_hidden;
  }
  dense_gradient(context, *d_above, view(gradient, weights_[0]), view(gradient, biases_[0]));
  if (d_context == nullptr) return;
  d_context->noalias() = *d_above * view(parameters, weights_[0]).transpose();
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
  const GaussianMixture q = mixture(scratch, 0);
  RowMatrixX<S> u(count, dimension_);
  for (Index i = 0; i < count; ++i) {
    StreamId row = id;
    row.row += static_cast<std::uint64_t>(i);
    Stream stream(row);
    u.row(i) = q.sample(stream).transpose().template cast<S>();
  }
  return u;
}

template class MixtureDensityNetwork<float>;
template class MixtureDensityNetwork<double>;

}  // namespace npdr::inference
