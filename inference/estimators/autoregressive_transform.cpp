#include "inference/estimators/autoregressive_transform.h"

#include <string>

#include "inference/estimators/dense.h"
#include "inference/estimators/scalar.h"

namespace npdr::inference {
namespace {

// Units that a block has at least: narrower products take longer than the masked ones they leave
// out. Another number changes the last bits of trainings.
constexpr Index kSmallestBlock = 16;

}  // namespace

template <typename S>
AutoregressiveTransform<S>::AutoregressiveTransform(Index dimension, Index hidden_features,
                                                    Index num_hidden_layers,
                                                    std::shared_ptr<const ElementMap<S>> map,
                                                    ParameterLayout& layout)
    : dimension_(dimension), hidden_(hidden_features), map_(std::move(map)) {
  const auto degree = [&](Index unit) { return unit * dimension / hidden_features; };
  for (Index g = 0; g <= dimension; ++g) {
    Index first = 0;
    while (first < hidden_ && degree(first) < g) ++first;
    first_.push_back(first);
  }
  unit_blocks_ = make_unit_blocks();
  const Size width{hidden_, "h"};
  std::vector<Index> degrees;
  for (Index unit = 0; unit < hidden_; ++unit) degrees.push_back(degree(unit));
  layout.note("degree", width, "how many of the first variables a hidden unit depends on", degrees);
  input_weight_ = layout.add("input.weight", {dimension, "v"}, width, "W_1, masked");
  for (Index l = 1; l < num_hidden_layers; ++l) {
    const std::string name = "hidden_" + std::to_string(l);
    hidden_weight_.push_back(layout.add(name + ".weight", width, width, "W_(l + 1), masked"));
    hidden_bias_.push_back(layout.add_bias(name + ".bias", width, "b_(l + 1)"));
  }
  const Size outputs{map_->num_parameters() * dimension, "p v"};
  output_weight_ = layout.add("output.weight", width, outputs,
                              "W_o, masked: column p v + d gives the p-th number of variable d");
  output_bias_ = layout.add_bias("output.bias", outputs, "b_o");

  input_mask_ = RowMatrixX<S>::NullaryExpr(dimension, hidden_,
                                           [&](Index d, Index j) { return S(d + 1 <= degree(j)); });
  hidden_mask_ = RowMatrixX<S>::NullaryExpr(
      hidden_, hidden_, [&](Index i, Index j) { return S(degree(i) <= degree(j)); });
  output_mask_ = RowMatrixX<S>::NullaryExpr(
      hidden_, outputs.value, [&](Index j, Index d) { return S(degree(j) <= d % dimension); });
}

template <typename S>
std::vector<typename AutoregressiveTransform<S>::UnitBlock>
AutoregressiveTransform<S>::make_unit_blocks() const {
  std::vector<UnitBlock> blocks;
  Index begin = 0;
  for (Index g = 1; g <= dimension_; ++g) {
    const Index end = first_of_degree(g);
    const bool last = g == dimension_;
    if (!last && (end - begin < kSmallestBlock || hidden_ - end < kSmallestBlock)) continue;
    blocks.push_back({begin, end});
    begin = end;
  }
  return blocks;
}

template <typename S>
void AutoregressiveTransform<S>::initialize(Parameters<S>& parameters, Stream& stream) const {
  RowMatrixX<S> no_bias;  // the bias of the first layer comes with the context
  initialize_dense(view(parameters, input_weight_), no_bias, stream);
  view(parameters, input_weight_).array() *= input_mask_.array();
  for (std::size_t l = 0; l < hidden_weight_.size(); ++l) {
    initialize_dense(view(parameters, hidden_weight_[l]), view(parameters, hidden_bias_[l]),
                     stream);
    view(parameters, hidden_weight_[l]).array() *= hidden_mask_.array();
  }
  // A small last layer starts the transform near the identity.
  initialize_dense(view(parameters, output_weight_), view(parameters, output_bias_), stream, 0.1);
  view(parameters, output_weight_).array() *= output_mask_.array();
}

template <typename S>
void AutoregressiveTransform<S>::forward(const Parameters<S>& parameters,
                                         const Eigen::Ref<const RowMatrixX<S>>& context,
                                         AutoregressiveScratch<S>& scratch, ColumnMatrixX<S>& z,
                                         VectorX<S>& log_det) const {
  const ColumnMatrixX<S>& u = scratch.input;
  scratch.hidden.resize(hidden_weight_.size() + 1);
  ColumnMatrixX<S>& first = scratch.hidden.front();
  repeat_groups(context, u.rows(), first);
  first.noalias() += u * view(parameters, input_weight_);
  first = first.array().tanh();
  for (std::size_t l = 0; l < hidden_weight_.size(); ++l) hidden_forward(parameters, l, scratch);
  dense(scratch.hidden.back(), view(parameters, output_weight_), view(parameters, output_bias_),
        scratch.element.raw);
  map_->forward(u, scratch.element, z, log_det);
}

template <typename S>
void AutoregressiveTransform<S>::hidden_forward(const Parameters<S>& parameters, std::size_t l,
                                                AutoregressiveScratch<S>& scratch) const {
  const auto weight = view(parameters, hidden_weight_[l]);
  const ColumnMatrixX<S>& below = scratch.hidden[l];
  ColumnMatrixX<S>& units = scratch.hidden[l + 1];
  repeat_groups(view(parameters, hidden_bias_[l]), below.rows(), units);
  for (const UnitBlock& b : unit_blocks_) {
    units.middleCols(b.begin, b.size()).noalias() +=
        below.leftCols(b.end) * weight.block(0, b.begin, b.end, b.size());
  }
  units = units.array().tanh();
}

template <typename S>
void AutoregressiveTransform<S>::hidden_backward(const Parameters<S>& parameters, std::size_t l,
                                                 AutoregressiveScratch<S>& scratch,
                                                 Parameters<S>& gradient) const {
  tanh_backward(scratch.hidden[l + 1], scratch.d_hidden);
  const auto weight = view(parameters, hidden_weight_[l]);
  auto d_weight = view(gradient, hidden_weight_[l]);
  scratch.d_below.resize(scratch.d_hidden.rows(), hidden_);
  for (const UnitBlock& b : unit_blocks_) {
    const Index seen_by = hidden_ - b.begin;
    auto d_columns = d_weight.middleCols(b.begin, b.size());
    d_columns.topRows(b.end).noalias() = scratch.hidden[l].leftCols(b.end).transpose() *
                                         scratch.d_hidden.middleCols(b.begin, b.size());
    d_columns.middleRows(b.begin, b.size()).array() *=
        hidden_mask_.block(b.begin, b.begin, b.size(), b.size()).array();
    d_columns.bottomRows(hidden_ - b.end).setZero();
    scratch.d_below.middleCols(b.begin, b.size()).noalias() =
        scratch.d_hidden.rightCols(seen_by) *
        weight.block(b.begin, b.begin, b.size(), seen_by).transpose();
  }
  view(gradient, hidden_bias_[l]).row(0) = scratch.d_hidden.colwise().sum();
  scratch.d_hidden.swap(scratch.d_below);
}

template <typename S>
void AutoregressiveTransform<S>::backward(const Parameters<S>& parameters,
                                          AutoregressiveScratch<S>& scratch,
                                          const VectorX<S>& d_log_det, ColumnMatrixX<S>& d_z,
                                          Parameters<S>& gradient,
                                          Eigen::Ref<RowMatrixX<S>> d_context) const {
  map_->backward(scratch.input, d_log_det, scratch.element, d_z);

  const ColumnMatrixX<S>& d_raw = scratch.element.d_raw;
  dense_gradient(scratch.hidden.back(), d_raw, view(gradient, output_weight_),
                 view(gradient, output_bias_));
  view(gradient, output_weight_).array() *= output_mask_.array();
  scratch.d_hidden.noalias() = d_raw * view(parameters, output_weight_).transpose();
  for (std::size_t l = hidden_weight_.size(); l-- > 0;) {
    hidden_backward(parameters, l, scratch, gradient);
  }
  tanh_backward(scratch.hidden.front(), scratch.d_hidden);
  view(gradient, input_weight_).noalias() = scratch.input.transpose() * scratch.d_hidden;
  view(gradient, input_weight_).array() *= input_mask_.array();
  sum_groups(scratch.d_hidden, d_context);
  d_z.noalias() += scratch.d_hidden * view(parameters, input_weight_).transpose();
}

template <typename S>
ColumnMatrixX<S> AutoregressiveTransform<S>::inverse(const Parameters<S>& parameters,
                                                     const Eigen::Ref<const RowMatrixX<S>>& context,
                                                     const ColumnMatrixX<S>& z) const {
  const auto w_in = view(parameters, input_weight_);
  const auto w_out = view(parameters, output_weight_);
  const auto b_out = view(parameters, output_bias_);
  const Index m = z.rows();
  ColumnMatrixX<S> u(m, dimension_), raw(m, map_->num_parameters());
  // By columns, so that a degree's units lie together.
  std::vector<ColumnMatrixX<S>> hidden(hidden_weight_.size() + 1, ColumnMatrixX<S>(m, hidden_));
  for (Index d = 0; d < dimension_; ++d) {
    // u_1..u_d are known, so the hidden units of degree d can be computed, and they never change.
    const Index begin = first_of_degree(d);
    const Index end = first_of_degree(d + 1);
    const Index width = end - begin;
    const auto finish = [&](auto&& units, const auto& bias) {
      units.rowwise() += bias.row(0).segment(begin, width);
      units = units.array().tanh();
    };
    if (width > 0) {
      auto first = hidden[0].middleCols(begin, width);
      first.noalias() = u.leftCols(d) * w_in.block(0, begin, d, width);
      finish(first, context);
      for (std::size_t l = 0; l < hidden_weight_.size(); ++l) {
        const auto w = view(parameters, hidden_weight_[l]);
        auto units = hidden[l + 1].middleCols(begin, width);
        units.noalias() = hidden[l].leftCols(end) * w.block(0, begin, end, width);
        finish(units, view(parameters, hidden_bias_[l]));
      }
    }
    const auto own = Eigen::seqN(d, raw.cols(), dimension_);
    const RowMatrixX<S> w = w_out(Eigen::seqN(0, end), own), b = b_out(Eigen::seqN(0, 1), own);
    raw.noalias() = hidden.back().leftCols(end) * w;
    raw.rowwise() += b.row(0);
    u.col(d) = map_->inverse(z.col(d), raw);
  }
  return u;
}

template class AutoregressiveTransform<NPDR_SCALAR>;

}  // namespace npdr::inference
