#include "inference/diagnostics/mlp_classifier.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"
#include "core/matrix_blocking.h"
#include "inference/estimators/dense.h"
#include "inference/estimators/softplus.h"
#include "inference/training/adam.h"

namespace npdr::inference {
namespace {

void require_shapes(const RowMatrixF& x, const VectorF& classes, Index num_features) {
  if (x.rows() >= 1 && x.rows() == classes.size() && x.cols() == num_features) return;
  throw ShapeError("classifier: x of " + std::to_string(x.rows()) + " rows and " +
                   std::to_string(x.cols()) + " features, " + std::to_string(classes.size()) +
                   " classes, must be as many rows and " + std::to_string(num_features) +
                   " features");
}

StreamId of_epoch(StreamId id, Index epoch) {
  id.epoch = static_cast<std::uint64_t>(epoch);
  return id;
}

// Products run fastest on whole vectors. Weights of the units that are added stay 0, and so do
// their outputs and gradients: they change nothing.
Index padded(Index units) {
  constexpr Index lanes = 16;
  return (units + lanes - 1) / lanes * lanes;
}

// The first `inputs` and `outputs` of the layer. scikit-learn draws biases like weights.
template <typename W, typename B>
void initialize_glorot(W weight, B bias, Index inputs, Index outputs, Stream& stream) {
  const auto in = static_cast<double>(inputs), out = static_cast<double>(outputs);
  initialize_dense(weight.topLeftCorner(inputs, outputs), bias.leftCols(outputs), stream,
                   std::sqrt(6.0 * in / (in + out)));
}

}  // namespace

MlpClassifier::MlpClassifier(Index num_features, const ClassifierConfig& config)
    : num_features_(num_features), config_(config) {
  if (num_features < 1 || config.hidden_features < 1 || config.batch_size < 1) {
    throw ShapeError("classifier: features, hidden_features and batch_size must be >= 1");
  }
  fix_matrix_blocking();
  const Index hidden = padded(config.hidden_features);
  ParameterLayout layout;
  weight_1_ = layout.add(num_features, hidden);
  bias_1_ = layout.add(1, hidden);
  weight_2_ = layout.add(hidden, hidden);
  bias_2_ = layout.add(1, hidden);
  weight_out_ = layout.add(hidden, 1);
  bias_out_ = layout.add(1, 1);
  parameters_ = Parameters<float>::Zero(layout.size());
}

void MlpClassifier::initialize(const StreamId& id) {
  const Index hidden = config_.hidden_features;
  parameters_.setZero();
  Stream stream(id);
  const auto initialize = [&](const Block& weight, const Block& bias, Index inputs, Index outputs) {
    initialize_glorot(view(parameters_, weight), view(parameters_, bias), inputs, outputs, stream);
  };
  initialize(weight_1_, bias_1_, num_features_, hidden);
  initialize(weight_2_, bias_2_, hidden, hidden);
  initialize(weight_out_, bias_out_, hidden, 1);
}

void MlpClassifier::forward(const RowMatrixF& x, Scratch& s) const {
  dense_relu(x, view(parameters_, weight_1_), view(parameters_, bias_1_), s.h1);
  dense_relu(s.h1, view(parameters_, weight_2_), view(parameters_, bias_2_), s.h2);
  dense(s.h2, view(parameters_, weight_out_), view(parameters_, bias_out_), s.f);
}

double MlpClassifier::penalty() const {
  double squares = 0.0;
  for (const Block& block : {weight_1_, weight_2_, weight_out_}) {
    squares += static_cast<double>(view(parameters_, block).squaredNorm());
  }
  return 0.5 * config_.l2 * squares;
}

double MlpClassifier::loss(const RowMatrixF& x, const VectorF& classes, Scratch& s,
                           Parameters<float>& gradient) const {
  const auto n = static_cast<float>(x.rows());
  forward(x, s);
  s.d_f = (((-s.f.array()).exp() + 1.0f).inverse() - classes.array()) / n;
  dense_gradient(s.h2, s.d_f, view(gradient, weight_out_), view(gradient, bias_out_));
  s.d2.noalias() = s.d_f * view(parameters_, weight_out_).transpose();
  relu_backward(s.h2, s.d2);
  dense_gradient(s.h1, s.d2, view(gradient, weight_2_), view(gradient, bias_2_));
  s.d1.noalias() = s.d2 * view(parameters_, weight_2_).transpose();
  relu_backward(s.h1, s.d1);
  dense_gradient(x, s.d1, view(gradient, weight_1_), view(gradient, bias_1_));
  for (const Block& block : {weight_1_, weight_2_, weight_out_}) {
    view(gradient, block) += static_cast<float>(config_.l2) / n * view(parameters_, block);
  }
  const double sum = (softplus(s.f.array()) - classes.array() * s.f.array()).cast<double>().sum();
  return (sum + penalty()) / static_cast<double>(n);
}

void MlpClassifier::train(const RowMatrixF& x, const VectorF& classes, const StreamId& id) {
  require_shapes(x, classes, num_features_);
  initialize(id);
  const Index n = x.rows();
  Adam optimizer(parameters_.size(), config_.learning_rate);
  Parameters<float> gradient = Parameters<float>::Zero(parameters_.size());
  Scratch scratch;
  RowMatrixF batch;
  VectorF batch_classes;
  double smallest = kInfinity;
  Index epochs_without_improvement = 0;
  for (Index epoch = 1; epoch <= config_.max_epochs; ++epoch) {
    const auto order = Stream(of_epoch(id, epoch)).permutation(static_cast<std::uint32_t>(n));
    double sum = 0.0;
    for (Index begin = 0; begin < n; begin += config_.batch_size) {
      const auto rows = Eigen::Map<const Eigen::Array<std::uint32_t, Eigen::Dynamic, 1>>(
          order.data() + begin, std::min(config_.batch_size, n - begin));
      batch = x(rows, Eigen::all);
      batch_classes = classes(rows);
      sum += loss(batch, batch_classes, scratch, gradient) * static_cast<double>(rows.size());
      optimizer.step(gradient, 1.0, parameters_);
    }
    const double mean = sum / static_cast<double>(n);
    const bool is_better = mean <= smallest - config_.tolerance;
    epochs_without_improvement = is_better ? 0 : epochs_without_improvement + 1;
    smallest = std::min(smallest, mean);
    if (epochs_without_improvement > config_.stop_after_epochs) return;
  }
}

VectorF MlpClassifier::logits(const RowMatrixF& x) const {
  constexpr Index block_rows = 1024;
  VectorF result(x.rows());
  Scratch scratch;
  for (Index begin = 0; begin < x.rows(); begin += block_rows) {
    const Index count = std::min(block_rows, x.rows() - begin);
    const RowMatrixF block = x.middleRows(begin, count);
    forward(block, scratch);
    result.segment(begin, count) = scratch.f;
  }
  return result;
}

}  // namespace npdr::inference
