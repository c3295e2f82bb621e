#include "inference/estimators/autoregressive_transform.h"

#include <cmath>

#include "inference/estimators/dense.h"

namespace npdr::inference {
namespace {

constexpr double kSmallestScale = 1e-3;
// softplus(kScaleOffset) + kSmallestScale = 1.
const double kScaleOffset = std::log(std::expm1(1.0 - kSmallestScale));

// log(1 + e^a) without overflow, vectorised.
template <typename Derived>
auto softplus(const Eigen::ArrayBase<Derived>& a) {
  using S = typename Derived::Scalar;
  return a.max(S(0)) + (-a.abs()).exp().log1p();
}

}  // namespace

template <typename S>
AutoregressiveTransform<S>::AutoregressiveTransform(Index dimension, Index hidden_features,
                                                    Index num_hidden_layers,
                                                    ParameterLayout& layout)
    : dimension_(dimension), hidden_(hidden_features) {
  const auto degree = [&](Index unit) { return unit * dimension / hidden_features; };
  for (Index g = 0; g <= dimension; ++g) {
    Index first = 0;
    while (first < hidden_ && degree(first) < g) ++first;
    first_.push_back(first);
  }
  input_weight_ = layout.add(dimension, hidden_);
  for (Index l = 1; l < num_hidden_layers; ++l) {
    hidden_weight_.push_back(layout.add(hidden_, hidden_));
    hidden_bias_.push_back(layout.add(1, hidden_));
  }
  output_weight_ = layout.add(hidden_, 2 * dimension);
  output_bias_ = layout.add(1, 2 * dimension);

  input_mask_ = RowMatrixX<S>::NullaryExpr(dimension, hidden_,
                                           [&](Index d, Index j) { return S(d + 1 <= degree(j)); });
  hidden_mask_ = RowMatrixX<S>::NullaryExpr(
      hidden_, hidden_, [&](Index i, Index j) { return S(degree(i) <= degree(j)); });
  output_mask_ = RowMatrixX<S>::NullaryExpr(
      hidden_, 2 * dimension, [&](Index j, Index d) { return S(degree(j) <= d % dimension); });
}

template <typename S>
void AutoregressiveTransform<S>::initialise(Parameters<S>& parameters, Stream& stream) const {
  RowMatrixX<S> no_bias;  // the bias of the first layer comes with the context
  initialise_dense(view(parameters, input_weight_), no_bias, stream);
  view(parameters, input_weight_).array() *= input_mask_.array();
  for (std::size_t l = 0; l < hidden_weight_.size(); ++l) {
    initialise_dense(view(parameters, hidden_weight_[l]), view(parameters, hidden_bias_[l]),
                     stream);
    view(parameters, hidden_weight_[l]).array() *= hidden_mask_.array();
  }
  // A small last layer starts the transform near the identity.
  initialise_dense(view(parameters, output_weight_), view(parameters, output_bias_), stream, 0.1);
  view(parameters, output_weight_).array() *= output_mask_.array();
}

template <typename S>
void AutoregressiveTransform<S>::forward(const Parameters<S>& parameters,
                                         const Eigen::Ref<const RowMatrixX<S>>& context,
                                         AutoregressiveScratch<S>& scratch, RowMatrixX<S>& z,
                                         VectorX<S>& log_det) const {
  const RowMatrixX<S>& u = scratch.input;
  scratch.hidden.resize(hidden_weight_.size() + 1);
  RowMatrixX<S>& first = scratch.hidden.front();
  first.noalias() = u * view(parameters, input_weight_);
  add_to_groups(context, first);
  first = first.array().tanh();
  for (std::size_t l = 0; l < hidden_weight_.size(); ++l) {
    dense_tanh(scratch.hidden[l], view(parameters, hidden_weight_[l]),
               view(parameters, hidden_bias_[l]), scratch.hidden[l + 1]);
  }
  dense(scratch.hidden.back(), view(parameters, output_weight_), view(parameters, output_bias_),
        scratch.raw);
  scratch.scale =
      softplus(scratch.raw.leftCols(dimension_).array() + S(kScaleOffset)) + S(kSmallestScale);
  z = u.array() * scratch.scale.array() + scratch.raw.rightCols(dimension_).array();
  log_det += scratch.scale.array().log().matrix().rowwise().sum();
}

template <typename S>
void AutoregressiveTransform<S>::backward(const Parameters<S>& parameters,
                                          AutoregressiveScratch<S>& scratch,
                                          const VectorX<S>& d_log_det, RowMatrixX<S>& d_z,
                                          Parameters<S>& gradient,
                                          Eigen::Ref<RowMatrixX<S>> d_context) const {
  const Index m = d_z.rows();
  scratch.d_raw.resize(m, 2 * dimension_);
  // ds/da = sigmoid(a + a_0) = 1 - exp(-softplus(a + a_0)).
  scratch.d_raw.leftCols(dimension_) =
      (d_z.array() * scratch.input.array() +
       scratch.scale.array().inverse().colwise() * d_log_det.array()) *
      (S(1) - (S(kSmallestScale) - scratch.scale.array()).exp());
  scratch.d_raw.rightCols(dimension_) = d_z;

  dense_gradient(scratch.hidden.back(), scratch.d_raw, view(gradient, output_weight_),
                 view(gradient, output_bias_));
  view(gradient, output_weight_).array() *= output_mask_.array();
  scratch.d_hidden.noalias() = scratch.d_raw * view(parameters, output_weight_).transpose();
  for (std::size_t l = hidden_weight_.size(); l-- > 0;) {
    tanh_backward(scratch.hidden[l + 1], scratch.d_hidden);
    dense_gradient(scratch.hidden[l], scratch.d_hidden, view(gradient, hidden_weight_[l]),
                   view(gradient, hidden_bias_[l]));
    view(gradient, hidden_weight_[l]).array() *= hidden_mask_.array();
    scratch.d_below.noalias() = scratch.d_hidden * view(parameters, hidden_weight_[l]).transpose();
    scratch.d_hidden.swap(scratch.d_below);
  }
  tanh_backward(scratch.hidden.front(), scratch.d_hidden);
  view(gradient, input_weight_).noalias() = scratch.input.transpose() * scratch.d_hidden;
  view(gradient, input_weight_).array() *= input_mask_.array();
  sum_groups(scratch.d_hidden, d_context);
  d_z = d_z.cwiseProduct(scratch.scale);
  d_z.noalias() += scratch.d_hidden * view(parameters, input_weight_).transpose();
}

template <typename S>
RowMatrixX<S> AutoregressiveTransform<S>::inverse(const Parameters<S>& parameters,
                                                  const Eigen::Ref<const RowMatrixX<S>>& context,
                                                  const RowMatrixX<S>& z) const {
  const auto w_in = view(parameters, input_weight_);
  const auto w_out = view(parameters, output_weight_);
  const auto b_out = view(parameters, output_bias_);
  const Index m = z.rows();
  RowMatrixX<S> u(m, dimension_);
  std::vector<RowMatrixX<S>> hidden(hidden_weight_.size() + 1, RowMatrixX<S>(m, hidden_));
  for (Index d = 0; d < dimension_; ++d) {
    // u_1..u_d are known, so the hidden units of degree d can be computed, and they never change.
    const Index begin = first_of_degree(d);
    const Index end = first_of_degree(d + 1);
    const Index width = end - begin;
    if (width > 0) {
      hidden[0].middleCols(begin, width) =
          ((u.leftCols(d) * w_in.block(0, begin, d, width)).rowwise() +
           context.row(0).segment(begin, width))
              .array()
              .tanh();
      for (std::size_t l = 0; l < hidden_weight_.size(); ++l) {
        const auto w = view(parameters, hidden_weight_[l]);
        const auto b = view(parameters, hidden_bias_[l]);
        hidden[l + 1].middleCols(begin, width) =
            ((hidden[l].leftCols(end) * w.block(0, begin, end, width)).rowwise() +
             b.row(0).segment(begin, width))
                .array()
                .tanh();
      }
    }
    const auto& top = hidden.back();
    const VectorX<S> a = (top.leftCols(end) * w_out.block(0, d, end, 1)).array() + b_out(0, d);
    const VectorX<S> t = (top.leftCols(end) * w_out.block(0, d + dimension_, end, 1)).array() +
                         b_out(0, d + dimension_);
    u.col(d) = (z.col(d) - t).array() / (softplus(a.array() + S(kScaleOffset)) + S(kSmallestScale));
  }
  return u;
}

template class AutoregressiveTransform<float>;
template class AutoregressiveTransform<double>;

}  // namespace npdr::inference
