/// A classifier of two classes: a perceptron with two hidden layers of rectified linear units,
///   h_1 = r(x W_1 + b_1),  h_2 = r(h_1 W_2 + b_2),  f = h_2 w + c,  P(class 1 | x) = 1 / (1 +
///   e^-f),
/// r = max(0, .), trained by Adam on
///   L = mean over the batch of [softplus(f) - y f] + l2 / (2 n) (|W_1|^2 + |W_2|^2 + |w|^2),
/// n being the rows of the batch and y the class. Architecture, initial weights (Glorot and Bengio
/// 2010, uniform on +-sqrt(6 / (inputs + outputs))), batches and stopping are those of
/// scikit-learn's MLPClassifier (Pedregosa et al. 2011), which the benchmarks of simulation-based
/// inference use.
#pragma once

#include "core/random.h"
#include "inference/estimators/parameters.h"

namespace npdr::inference {

/// Defaults are scikit-learn's, but for the epochs, which are the benchmark's.
struct ClassifierConfig {
  Index hidden_features = 100;  ///< of each hidden layer
  double learning_rate = 1e-3;
  Index batch_size = 200;  ///< or all rows, when there are fewer
  double l2 = 1e-4;        ///< weight of the penalty
  Index max_epochs = 10'000;
  Index stop_after_epochs = 10;  ///< in a row whose loss isn't `tolerance` below the smallest one
  double tolerance = 1e-4;       ///< [nats]
};

/// Const calls are thread-safe.
class MlpClassifier {
 public:
  /// Throws ShapeError for sizes below 1.
  MlpClassifier(Index num_features, const ClassifierConfig& config);

  /// Trains on x (n, D) with classes (n), 0 or 1, from fresh weights, all randomness from `id`.
  /// Computes on one thread. Throws ShapeError when shapes don't go together.
  void train(const RowMatrixF& x, const VectorF& classes, const StreamId& id);

  /// f of each row of x (n, D), in nats, (n).
  VectorF logits(const RowMatrixF& x) const;

 private:
  /// Memory of a forward pass for the backward pass.
  struct Scratch {
    RowMatrixF h1, h2, d1, d2;
    VectorF f, d_f;
  };
  void initialize(const StreamId& id);
  void forward(const RowMatrixF& x, Scratch& scratch) const;
  double loss(const RowMatrixF& x, const VectorF& classes, Scratch& scratch,
              Parameters<float>& gradient) const;
  double penalty() const;

  Index num_features_;
  ClassifierConfig config_;
  Block weight_1_, bias_1_, weight_2_, bias_2_, weight_out_, bias_out_;
  Parameters<float> parameters_;
};

}  // namespace npdr::inference
