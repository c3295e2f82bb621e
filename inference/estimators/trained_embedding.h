/// The layers in front of a density estimator that are trained with it: convolutions over the steps
/// of rollouts, with the same weights for each rollout, and a linear layer.
///
///   y_0 = z as (H, K, C),
///   y_l[h, t] = max(0, vec(y_{l-1}[h, 4 t + o], ..., y_{l-1}[h, 4 t + o + 7]) W_l + b_l),
///   c = vec(y_L) W + b;   or, with the mean over rollouts,   c = vec(mean_h y_L[h]) W + b.
///
/// Each convolution gives 32 channels and makes four steps one; they go on until at most seven
/// steps are left. o in 0..3 is such that the last step is seen. Of at most seven steps there is
/// one of all of them where the mean over rollouts follows; else the linear layer alone. z: (n, H K
/// C), rollout by rollout, step by step. (Strided convolutions as in LeCun et al. 1998; max(0, .)
/// as initialized by He et al. 2015; the mean over rollouts after Zaheer et al. 2017, "Deep sets".)
#pragma once

#include <vector>

#include "core/random.h"
#include "inference/estimators/parameters.h"

namespace npdr::inference {

/// The series that a row of z holds.
struct SeriesShape {
  Index num_rollouts = 0;  ///< H
  Index num_steps = 0;     ///< K
  Index num_channels = 0;  ///< C

  Index num_values() const { return num_rollouts * num_steps * num_channels; }
  bool operator==(const SeriesShape&) const = default;
};

/// Which layers are trained.
struct TrainedEmbeddingConfig {
  Index features = 0;             ///< width of the last layer; 0: none is trained, c = z
  SeriesShape series = {};        ///< for convolutions; of 0 values: the linear layer alone
  bool average_rollouts = false;  ///< the mean over rollouts, in place of each by itself

  bool has_convolutions() const { return series.num_values() > 0; }
  bool operator==(const TrainedEmbeddingConfig&) const = default;
};

template <typename S>
class TrainedEmbedding {
 public:
  struct Scratch {
    std::vector<RowMatrixX<S>> y;    ///< (n H K_l, 32) of each convolution
    std::vector<RowMatrixX<S>> d_y;  ///< dL/dy
    RowMatrixX<S> mean;              ///< over rollouts, (n, K_L 32)
    RowMatrixX<S> d_mean;
  };

  /// For rows of `num_inputs` features; config.features > 0. Throws ShapeError when the series has
  /// another number of values.
  TrainedEmbedding(const TrainedEmbeddingConfig& config, Index num_inputs, ParameterLayout& layout);

  void initialize(Parameters<S>& parameters, Stream& stream) const;

  /// z (n, F) -> context (n, features).
  void forward(const Parameters<S>& parameters, const RowMatrixX<S>& z, Scratch& scratch,
               RowMatrixX<S>& context) const;
  /// The gradient of the layers' weights from dL/dcontext, overwritten; after forward() of z.
  void backward(const Parameters<S>& parameters, const RowMatrixX<S>& z,
                const RowMatrixX<S>& d_context, Scratch& scratch, Parameters<S>& gradient) const;

 private:
  struct Convolution {
    Index kernel, steps_in, channels_in, steps_out;
    Block weight = {}, bias = {};  ///< (kernel channels_in, 32), (1, 32)
    Index offset() const;
    Index values_in() const { return steps_in * channels_in; }
  };
  using Patches = Eigen::Map<const RowMatrixX<S>, 0, Eigen::OuterStride<>>;
  using Flat = Eigen::Map<const RowMatrixX<S>>;

  Patches patches(const Convolution& layer, const S* series) const;
  void convolve(const Parameters<S>& parameters, const Convolution& layer, const S* input,
                Index count, RowMatrixX<S>& y) const;
  void convolution_gradient(const Convolution& layer, const S* input, const RowMatrixX<S>& d_y,
                            Parameters<S>& gradient) const;
  void input_gradient(const Parameters<S>& parameters, const Convolution& layer,
                      const RowMatrixX<S>& d_y, RowMatrixX<S>& d_input) const;
  Flat last_inputs(const RowMatrixX<S>& z, const Scratch& scratch) const;
  void last_input_gradient(const Parameters<S>& parameters, const RowMatrixX<S>& d_context,
                           Scratch& scratch) const;

  SeriesShape series_;
  bool average_rollouts_;
  std::vector<Convolution> convolutions_;
  Block weight_;  ///< (inputs, features) of the linear layer
  Block bias_;    ///< (1, features)
};

}  // namespace npdr::inference
